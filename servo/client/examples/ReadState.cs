// SPDX-License-Identifier: Apache-2.0
// Prints what the first device does, ten times a second, and meanwhile moves an object of the scene
// to and fro (the first one, unless another is named) and brakes the hand a little. At the end it prints how the loop kept time.
// In Unity the body of the loop is a MonoBehaviour's FixedUpdate.
// Usage: ReadState.exe [SOCKET [TIMES [OBJECT]]]
using System;
using System.Globalization;
using System.Threading;
using SpmHaptics;

public static class ReadState
{
    private static string Text(string form, params object[] values)
    {
        return string.Format(CultureInfo.InvariantCulture, form, values);
    }

    private static void PrintHand(SpmClient client)
    {
        var hand = client.Device(0);
        Console.WriteLine(Text(
            "tick {0}: {1} at {2:F2} {3:F2} {4:F2} mm, force {5:F2} {6:F2} {7:F2} N{8}{9}",
            hand.Tick, client.DeviceName(0), hand.Position[0] * 1e3, hand.Position[1] * 1e3,
            hand.Position[2] * 1e3, hand.Force[0], hand.Force[1], hand.Force[2],
            hand.Contact != 0 ? ", in contact" : "",
            hand.Cause != 0 ? ", no force: " + client.CauseText(hand.Cause) : ""));
    }

    /// The end of the bucket, ns, up to which this fraction of the ticks lies.
    private static ulong Percentile(ulong[] buckets, double share)
    {
        ulong all = 0, below = 0;
        foreach (ulong count in buckets) all += count;
        for (uint i = 0; i < buckets.Length; ++i)
        {
            below += buckets[i];
            if (below >= share * all) return SpmClient.BucketEnd(i);
        }
        return 0;
    }

    private static void PrintCounts(SpmClient client)
    {
        var loop = client.Loop();
        var counts = client.DeviceCounts(0);
        Console.WriteLine(Text("loop: {0} ticks, {1} missed, late p99 {2:F1} us, busy p99 {3:F1} us",
                               loop.Ticks, loop.Missed, Percentile(loop.Wake, 0.99) * 1e-3,
                               Percentile(loop.Busy, 0.99) * 1e-3));
        Console.WriteLine(Text("{0}: {1} ticks in contact, largest force {2:F2} N",
                               client.DeviceName(0), counts.ContactTicks, counts.ForceMax));
        foreach (var application in client.Applications())
        {
            Console.WriteLine(Text("connected: {0} (process {1})", application.Name,
                                   application.Process));
        }
    }

    public static int Main(string[] arguments)
    {
        string path = arguments.Length > 0 ? arguments[0] : null;
        int times = arguments.Length > 1 ? int.Parse(arguments[1], CultureInfo.InvariantCulture) : 50;
        ulong moved = arguments.Length > 2 ? ulong.Parse(arguments[2], CultureInfo.InvariantCulture) : 0;
        try
        {
            using (var client = new SpmClient(path, "ReadState example"))
            {
                var start = client.Object(moved);
                client.SetEffect(0, 0, new EffectData { Kind = EffectKind.Viscous, Damping = 1 });
                for (int i = 0; i < times; ++i)
                {
                    var place = (double[])start.Position.Clone();
                    place[0] += 0.01 * Math.Sin(0.3 * i);
                    client.Move(moved, place, start.Orientation, 0.1);
                    Thread.Sleep(100);
                    PrintHand(client);
                }
                PrintCounts(client);
                var commands = client.Commands();
                if (commands.Refused > 0)
                {
                    Console.Error.WriteLine(Text("refused {0} times: {1}", commands.Refused,
                                                 SpmClient.RefusalText(commands.LastRefusal)));
                    return 3;
                }
            }
            return 0;
        }
        catch (ClientException problem)
        {
            Console.Error.WriteLine("error: " + problem.Message);
            return 2;
        }
    }
}

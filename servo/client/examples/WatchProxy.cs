// SPDX-License-Identifier: Apache-2.0
// Waits for each tick of the loop, and prints the first device's place, that of its proxy, where the
// surface holds the tool, and the force, which it holds below a cap. After a fault that the daemon
// wants acknowledged (run --recovery acknowledge) it asks, and acknowledges it.
// Usage: WatchProxy.exe [SOCKET [TICKS [NEWTONS]]]
using System;
using System.Globalization;
using System.Linq;
using SpmHaptics;

public static class WatchProxy
{
    private static string Text(double[] values, double factor)
    {
        return string.Join(" ", values.Select(
            value => (factor * value).ToString("F2", CultureInfo.InvariantCulture)));
    }

    public static int Main(string[] arguments)
    {
        var culture = CultureInfo.InvariantCulture;
        string path = arguments.Length > 0 ? arguments[0] : null;
        int ticks = arguments.Length > 1 ? int.Parse(arguments[1], culture) : 1000;
        double cap = arguments.Length > 2 ? double.Parse(arguments[2], culture) : 2;
        try
        {
            using (var client = new SpmClient(path, "WatchProxy example"))
            {
                client.SetForceCap(0, cap);
                ulong last = 0;
                for (int i = 0; i < ticks; ++i)
                {
                    TickData tick;
                    if (!client.WaitTick(last, 1, out tick))
                    {
                        Console.Error.WriteLine(
                            "error: no tick for a second: look at the daemon");
                        return 3;
                    }
                    last = tick.Tick;
                    var hand = client.Device(0);
                    Console.WriteLine("tick " + hand.Tick + ": hand " + Text(hand.Position, 1e3) +
                                      " mm, proxy " + Text(hand.Proxy, 1e3) + " mm, force " +
                                      Text(hand.Force, 1) + " N");
                    if (hand.Cause == SpmClient.Unacknowledged)
                    {
                        Console.WriteLine(
                            "The force is off after a fault. Is all well again? Press Enter.");
                        Console.ReadLine();
                        client.Acknowledge(0);
                    }
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

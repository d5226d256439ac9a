// SPDX-License-Identifier: Apache-2.0
// Uses each function of SpmClient.cs beside client_test_daemon and prints what came of it, a fact a
// line; client_package_test.py judges them. Usage: ClientTest.exe sizes | SOCKET
using System;
using System.Collections.Generic;
using System.Globalization;
using System.Linq;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Threading;
using SpmHaptics;

public static class ClientTest
{
    private static readonly double[] Upright = { 1, 0, 0, 0 };

    private static void Tell(string name, object value)
    {
        Console.WriteLine(string.Format(CultureInfo.InvariantCulture, "{0}={1}", name, value));
        Console.Out.Flush();
    }

    private static bool Eventually(Func<bool> so)
    {
        for (int i = 0; i < 10000 && !so(); ++i) Thread.Sleep(2);
        return so();
    }

    private static int TellSizes()
    {
        foreach (var kind in Assembly.GetExecutingAssembly().GetTypes())
        {
            if (kind.Namespace == "SpmHaptics" && kind.IsValueType && kind.Name.EndsWith("Data"))
            {
                Tell(kind.Name, Marshal.SizeOf(kind));
            }
        }
        return 0;
    }

    private static void TellDaemon(SpmClient client)
    {
        double age;
        Tell("running", Eventually(() => client.State(out age) == DaemonState.Running));
        var info = client.Info();
        Tell("process", info.Process);
        Tell("rate", info.RateHz);
        Tell("versions", info.DaemonVersion == info.LibraryVersion);
        Tell("names", client.DeviceName(0) + " " + client.AssetName(0) + " " + client.ObjectName(0));
    }

    private static void TellObjects(SpmClient client)
    {
        var material = new MaterialData
        {
            Fields = MaterialFields.Stiffness | MaterialFields.Texture,
            Stiffness = 800, TextureAmplitude = 5e-5, TextureWavelength = 1e-3, TextureSeed = 3
        };
        ulong added = client.Add(0, new[] { 0.1, 0, 0 }, Upright, 2, material);
        Tell("added", Eventually(() => Has(client, added)) && client.Object(added).Scale == 2);
        client.Move(added, new[] { 0.2, 0.3, 0.4 }, new double[] { 0, 1, 0, 0 }, 1.0 / 90);
        Tell("moved", Eventually(() => client.Object(added).Position.SequenceEqual(
                                           new[] { 0.2, 0.3, 0.4 })));
        Tell("turned", client.Object(added).Orientation[1]);
        client.SetMaterial(added, new MaterialData { Fields = MaterialFields.Damping, Damping = 2 });
        client.SetClutch(0, true);
        client.SetForceCap(0, 1.5);
        client.SetMethod(added, ForceMethod.Proxy);
        client.Stabilize(false);
        client.Push(0, new[] { 0, 0.5, 0 }, 0.1);
        client.SetEffect(0, 3, new EffectData
        {
            Kind = EffectKind.Detents, Stiffness = 100, Spacing = 0.004, Axis = new double[] { 0, 1, 0 }
        });
        client.SetEffect(0, 4, new EffectData { Kind = EffectKind.Magnet, Stiffness = 100 });
        client.RemoveEffect(0, 3);
        client.RemoveEffect(0);
        try
        {
            client.Push(0, new[] { 1e9, 0, 0 }, 0.1);
        }
        catch (ClientException problem)
        {
            Tell("too_hard", problem.Code);
        }
        TellLive(client);
        client.Acknowledge(0);
        TickData first, next;
        Tell("waited", client.WaitTick(0, 20, out first) &&
                       client.WaitTick(first.Tick, 20, out next) && next.Tick > first.Tick);
        Tell("waited_in_vain", client.WaitTick(ulong.MaxValue, 0.01, out next));
        Tell("proxy", client.Device(0).Proxy.Length);
        client.Remove(added);
        Tell("removed", Eventually(() => !Has(client, added)));
        Tell("refused", client.Commands().Refused);
        client.Move(added, new double[3], Upright, 0);
        Tell("refused_then", Eventually(() => client.Commands().Refused == 1));
        Tell("reason", SpmClient.RefusalText(client.Commands().LastRefusal));
        try
        {
            client.Move(0, new[] { double.NaN, 0, 0 }, Upright, 0);
        }
        catch (ClientException problem)
        {
            Tell("not_a_number", problem.Code);
        }
    }

    private static void TellLive(SpmClient client)
    {
        Tell("hand", client.Device(0).Hand);
        client.LeadHand(0, new[] { 0, 0.01, 0 }, Upright);
        Tell("led", Eventually(() => client.Device(0).Hand == HandState.Led));
        client.FreeHand(0);
        Tell("freed", Eventually(() => client.Device(0).Hand == HandState.Free));
        var feel = client.Feel(0);
        Tell("feel", string.Format(CultureInfo.InvariantCulture, "{0} {1} {2} {3} {4}", feel.Method,
                                   feel.Stabilized, feel.Stiffness, feel.FrictionSlide, feel.TextureSeed));
        double bare, stabilized;
        client.Borders(0, out bare, out stabilized);
        Tell("borders", string.Format(CultureInfo.InvariantCulture, "{0} {1}", bare, stabilized));
        Tell("path", client.AssetPath(0));
    }

    private static bool Has(SpmClient client, ulong id)
    {
        try
        {
            return client.Object(id).Id == id;
        }
        catch (ClientException problem)
        {
            if (problem.Code != ClientCode.NotThere) throw;
            return false;
        }
    }

    /// Says a word, upon which the daemon's device is made to do something.
    private static void TellEvents(SpmClient client)
    {
        var kinds = new List<EventKind>();
        Func<EventKind, bool> came = kind => Eventually(() => {
            EventData next;
            while (client.NextEvent(out next)) kinds.Add(next.Kind);
            return kinds.Contains(kind);
        });
        EventData old;
        while (client.NextEvent(out old)) { }
        Tell("now", "contact");
        Tell("contact", came(EventKind.ContactBegan));
        Eventually(() => client.Contacts(0).Count == 2);
        var contacts = client.Contacts(0);
        Tell("contacts", string.Format(CultureInfo.InvariantCulture, "{0} {1} {2} {3}", contacts.Count,
                                       contacts[0].Place[2], contacts[1].Object,
                                       client.Device(0).ToolPosition[1]));
        Tell("now", "button");
        Tell("button", came(EventKind.ButtonPressed));
        Tell("now", "gone");
        Tell("cut", came(EventKind.ForceCut));
        Tell("cause", client.CauseText(client.Device(0).Cause));
    }

    private static void TellCounts(SpmClient client)
    {
        var loop = client.Loop();
        Tell("ticks", loop.Ticks);
        Tell("missed", loop.Missed - loop.Ticks);
        Tell("skipped", loop.Skipped - loop.Ticks);
        Tell("busy_max", loop.BusyMaxNs);
        Tell("wake", string.Join(" ", BucketsWithTicks(loop.Wake)));
        Tell("busy", string.Join(" ", BucketsWithTicks(loop.Busy)));
        Tell("all_woke", loop.Wake.Aggregate((a, b) => a + b) == loop.Ticks);
        Tell("bucket_end", SpmClient.BucketEnd(1));
        var counts = client.DeviceCounts(0);
        Tell("contact_ticks", counts.ContactTicks > 0);
        Tell("counts", string.Format(CultureInfo.InvariantCulture, "{0} {1} {2} {3} {4}",
                                     counts.CapHits, counts.SlewHits, counts.ForceMax,
                                     counts.Energy, counts.GeneratedMax));
        foreach (var application in client.Applications())
        {
            Tell("application", application.Name + " " + application.Process);
        }
    }

    private static IEnumerable<int> BucketsWithTicks(ulong[] buckets)
    {
        return Enumerable.Range(0, buckets.Length).Where(i => buckets[i] > 0);
    }

    public static int Main(string[] arguments)
    {
        if (arguments[0] == "sizes") return TellSizes();
        using (var client = new SpmClient(arguments[0], "C# test"))
        {
            TellDaemon(client);
            TellObjects(client);
            TellEvents(client);
            TellCounts(client);
        }
        try
        {
            using (new SpmClient(arguments[0] + ".not")) { }
        }
        catch (ClientException problem)
        {
            Tell("without_daemon", problem.Code + " " + problem.Message);
        }
        return 0;
    }
}

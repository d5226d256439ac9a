// SPDX-License-Identifier: Apache-2.0
// Prints what the first device does, ten times a second, and moves the scene's first object to and
// fro meanwhile. In Unity the body of the loop is a MonoBehaviour's FixedUpdate.
// Usage: ReadState.exe [SOCKET [TIMES]]
using System;
using System.Globalization;
using System.Threading;
using SpmHaptics;

public static class ReadState
{
    public static int Main(string[] arguments)
    {
        string path = arguments.Length > 0 ? arguments[0] : null;
        int times = arguments.Length > 1 ? int.Parse(arguments[1], CultureInfo.InvariantCulture) : 50;
        try
        {
            using (var client = new SpmClient(path, "ReadState example"))
            {
                var start = client.Object(0);
                for (int i = 0; i < times; ++i)
                {
                    var place = (double[])start.Position.Clone();
                    place[0] += 0.01 * Math.Sin(0.3 * i);
                    client.Move(0, place, start.Orientation, 0.1);
                    Thread.Sleep(100);
                    var hand = client.Device(0);
                    Console.WriteLine(string.Format(
                        CultureInfo.InvariantCulture,
                        "tick {0}: {1} at {2:F2} {3:F2} {4:F2} mm, force {5:F2} N in y{6} {7}",
                        hand.Tick, client.DeviceName(0), hand.Position[0] * 1e3,
                        hand.Position[1] * 1e3, hand.Position[2] * 1e3, hand.Force[1],
                        hand.Contact != 0 ? ", in contact" : "", client.CauseText(hand.Cause)));
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

// SPDX-License-Identifier: Apache-2.0
// What the hand of a daemon feels at its next tick: Watch SOCKET.
using System;
using SpmHaptics;

internal static class Watch
{
    private static int Main(string[] arguments)
    {
        try
        {
            using (var client = new SpmClient(arguments[0]))
            {
                TickData tick;
                if (!client.WaitTick(0, 10, out tick)) return 3;
                var force = client.Device(0).Force;
                var size = Math.Sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
                Console.WriteLine(
                    size.ToString("F3", System.Globalization.CultureInfo.InvariantCulture) + " N");
                return 0;
            }
        }
        catch (ClientException problem)
        {
            Console.Error.WriteLine(problem.Message);
            return 2;
        }
    }
}

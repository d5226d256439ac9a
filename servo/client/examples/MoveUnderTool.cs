// SPDX-License-Identifier: Apache-2.0
// Moves an object up and down under the tool that the first device's hand holds (a scene with
// [tool] asset), and prints where the tool lies, where it touches, and what the tools do to the
// object. Usage: MoveUnderTool.exe [SOCKET [OBJECT [SECONDS [MILLIMETRES]]]]
using System;
using System.Globalization;
using System.Linq;
using System.Threading;
using SpmHaptics;

public static class MoveUnderTool
{
    private const double Rate = 60;       // poses a second
    private const double Frequency = 0.5; // 1/s

    private static string InMm(double[] vector)
    {
        return string.Join(" ", vector.Select(
            value => (1e3 * value).ToString("F2", CultureInfo.InvariantCulture)));
    }

    private static string Size(double[] vector, string format)
    {
        return Math.Sqrt(vector.Sum(value => value * value))
            .ToString(format, CultureInfo.InvariantCulture);
    }

    private static void Print(SpmClient client, ulong number)
    {
        var hand = client.Device(0);
        var moved = client.Object(number);
        var contacts = client.Contacts(0);
        Console.WriteLine("tool at " + InMm(hand.ToolPosition) + " mm touches at " + contacts.Count +
                          " places; object " + number + ": reaction " + Size(moved.Force, "F2") +
                          " N, " + Size(moved.Torque, "F4") + " N m");
        foreach (var contact in contacts)
        {
            Console.WriteLine("  at " + InMm(contact.Place) + " mm on object " + contact.Object + ": " +
                              Size(contact.Force, "F2") + " N, " +
                              (1e3 * contact.Depth).ToString("F3", CultureInfo.InvariantCulture) +
                              " mm deep");
        }
    }

    public static int Main(string[] arguments)
    {
        var culture = CultureInfo.InvariantCulture;
        string path = arguments.Length > 0 ? arguments[0] : null;
        ulong number = arguments.Length > 1 ? ulong.Parse(arguments[1], culture) : 0;
        double seconds = arguments.Length > 2 ? double.Parse(arguments[2], culture) : 10;
        double amplitude = arguments.Length > 3 ? double.Parse(arguments[3], culture) * 1e-3 : 2e-3;
        try
        {
            using (var client = new SpmClient(path, "MoveUnderTool example"))
            {
                TickData tick;
                client.WaitTick(0, 1, out tick); // a daemon may be so young that it had none
                var start = client.Object(number);
                var place = (double[])start.Position.Clone();
                for (int frame = 0; frame < seconds * Rate; ++frame)
                {
                    place[1] = start.Position[1] +
                               amplitude * Math.Sin(2 * Math.PI * Frequency * frame / Rate);
                    client.Move(number, place, start.Orientation, 1 / Rate);
                    if (frame % 6 == 0) Print(client, number);
                    Thread.Sleep((int)(1000 / Rate));
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

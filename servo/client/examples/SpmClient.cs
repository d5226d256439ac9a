// SPDX-License-Identifier: Apache-2.0
// libspm_client from C#, as Unity uses native libraries: put libspm_client.so into
// Assets/Plugins/x86_64 and this file anywhere under Assets. World frame: right-handed, x to the
// right, y up, z towards the user, metres; Unity's z points away from the user, so negate z of
// positions and forces, and x and y of quaternions, on the way in and out.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace SpmHaptics
{
    public enum ClientCode
    {
        Ok = 0, BadArgument = 1, NoDaemon = 2, Refused = 3, Internal = 4, VersionDiffers = 5,
        RingFull = 6, Busy = 7, NotThere = 8
    }

    public enum DaemonState { Running = 0, Stalled = 1, Ended = 2, Gone = 3 }

    [StructLayout(LayoutKind.Sequential)]
    public struct DeviceData
    {
        public uint Size;
        public uint Connected;
        public ulong Tick;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Position;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] Orientation; // w x y z
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Velocity;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Force;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Torque;
        public double Depth;
        public uint Contact;
        public uint Buttons;
        public uint Cause;
        public uint Health;
        public uint Contacts;
        public uint Cuts;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectData
    {
        public uint Size;
        public uint Asset;
        public ulong Id;
        public ulong Tick;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Position;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] Orientation;
        public double Scale;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Force;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Torque;
        public double Silent;
        public uint Movable;
        public uint Contact;
        public uint Driven;
        public uint Reserved;
    }

    public sealed class ClientException : Exception
    {
        public ClientCode Code { get; }
        public ClientException(ClientCode code, string message) : base(message) { Code = code; }
    }

    /// <summary>A connection to spm-servo. Dispose it when the scene ends.</summary>
    public sealed class SpmClient : IDisposable
    {
        private IntPtr handle;

        public SpmClient(string path = null, string application = "unity", int timeoutMs = 1000)
        {
            var options = new Options
            {
                Size = (uint)Marshal.SizeOf(typeof(Options)),
                TimeoutMs = timeoutMs,
                Path = path,
                Application = application
            };
            var message = new byte[512];
            var code = spm_client_connect(ref options, out handle, message,
                                          (UIntPtr)message.Length);
            if (code != ClientCode.Ok) throw new ClientException(code, TextOf(message));
        }

        public void Dispose()
        {
            if (handle != IntPtr.Zero) spm_client_disconnect(handle);
            handle = IntPtr.Zero;
        }

        public DaemonState State(out double age) { return spm_client_daemon_state(handle, out age); }

        public string DeviceName(uint device)
        {
            var name = new byte[64];
            Check(spm_client_device_name(handle, device, name, (UIntPtr)name.Length));
            return TextOf(name);
        }

        /// <summary>Why the force is zero and what to do about it; empty while there is force.</summary>
        public string CauseText(uint cause)
        {
            if (cause == 0) return "";
            IntPtr name, cure;
            spm_client_cause(handle, cause, out name, out cure);
            return Marshal.PtrToStringAnsi(name) + ": " + Marshal.PtrToStringAnsi(cure);
        }

        public DeviceData Device(uint device = 0)
        {
            var data = new DeviceData { Size = (uint)Marshal.SizeOf(typeof(DeviceData)) };
            Check(spm_client_read_device(handle, device, ref data));
            return data;
        }

        public ObjectData Object(ulong id)
        {
            var data = new ObjectData { Size = (uint)Marshal.SizeOf(typeof(ObjectData)) };
            Check(spm_client_read_object(handle, id, ref data));
            return data;
        }

        /// <summary>Sends a pose, w x y z; period in s is the time to the next one.</summary>
        public void Move(ulong id, double[] position, double[] orientation, double period)
        {
            var pose = new Pose
            {
                Size = (uint)Marshal.SizeOf(typeof(Pose)),
                Position = position,
                Orientation = orientation,
                Period = period
            };
            Check(spm_client_move_object(handle, id, ref pose));
        }

        private static void Check(ClientCode code)
        {
            if (code != ClientCode.Ok)
            {
                throw new ClientException(code, "spm-servo: " + code + " (see spm_client.h)");
            }
        }

        private static string TextOf(byte[] bytes)
        {
            int end = Array.IndexOf(bytes, (byte)0);
            return Encoding.UTF8.GetString(bytes, 0, end < 0 ? bytes.Length : end);
        }

        [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
        private struct Options
        {
            public uint Size;
            public int TimeoutMs;
            [MarshalAs(UnmanagedType.LPStr)] public string Path;
            [MarshalAs(UnmanagedType.LPStr)] public string Name;
            [MarshalAs(UnmanagedType.LPStr)] public string Application;
        }

        [StructLayout(LayoutKind.Sequential)]
        private struct Pose
        {
            public uint Size;
            public uint Reserved;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Position;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] Orientation;
            public double Period;
            public double Deadline;
        }

        private const string Library = "spm_client";

        [DllImport(Library)]
        private static extern ClientCode spm_client_connect(ref Options options, out IntPtr client,
                                                            [Out] byte[] message, UIntPtr size);
        [DllImport(Library)]
        private static extern void spm_client_disconnect(IntPtr client);
        [DllImport(Library)]
        private static extern DaemonState spm_client_daemon_state(IntPtr client, out double age);
        [DllImport(Library)]
        private static extern ClientCode spm_client_device_name(IntPtr client, uint device,
                                                                [Out] byte[] name, UIntPtr size);
        [DllImport(Library)]
        private static extern ClientCode spm_client_cause(IntPtr client, uint cause,
                                                          out IntPtr name, out IntPtr cure);
        [DllImport(Library)]
        private static extern ClientCode spm_client_read_device(IntPtr client, uint device,
                                                                ref DeviceData data);
        [DllImport(Library)]
        private static extern ClientCode spm_client_read_object(IntPtr client, ulong id,
                                                                ref ObjectData data);
        [DllImport(Library)]
        private static extern ClientCode spm_client_move_object(IntPtr client, ulong id,
                                                                ref Pose pose);
    }
}

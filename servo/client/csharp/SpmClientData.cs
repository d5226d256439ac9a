// SPDX-License-Identifier: Apache-2.0
// The structs of spm_client.h, in its order and units, with the layout of C. SpmClient.cs sets
// every Size.
using System;
using System.Runtime.InteropServices;

namespace SpmHaptics
{
    public enum ClientCode
    {
        Ok = 0, BadArgument = 1, NoDaemon = 2, Refused = 3, Internal = 4, VersionDiffers = 5,
        RingFull = 6, Busy = 7, NotThere = 8, NotMovable = 9
    }

    /// <summary>A supervisor may change what belongs to other applications, an observer nothing.</summary>
    public enum ClientRole : uint { Application = 0, Supervisor = 1, Observer = 2 }

    public enum DaemonState { Running = 0, Stalled = 1, Ended = 2, Gone = 3 }

    public enum EventKind
    {
        ContactBegan = 1, ContactEnded = 2, ButtonPressed = 3, ButtonReleased = 4, ForceCut = 5,
        ForceBack = 6, DeviceLost = 7, DeviceFound = 8, DaemonLost = 9, DaemonFound = 10
    }

    /// <summary>Which parts of a material are set; the rest stays as it is.</summary>
    [Flags]
    public enum MaterialFields : uint { None = 0, Stiffness = 1, Friction = 2, Damping = 4, Texture = 8 }

    /// <summary>Which limits a tick met: the caps of what was sent, and of the coupling of hand and
    /// tool.</summary>
    [Flags]
    public enum ClientLimits : uint { None = 0, ForceCap = 1, TorqueCap = 2, ToolCap = 4 }

    /// <summary>Spring: pulls towards Point. Viscous: brakes. Magnet: pulls from outside towards the
    /// surface of Object. Detents: pull along Axis to the nearest of places Spacing apart, one of
    /// which is at Point.</summary>
    public enum EffectKind : uint { Spring = 1, Viscous = 2, Magnet = 3, Detents = 4 }

    /// <summary>Own: the hand goes its own way. Free: applications may lead it
    /// (--device sim:hand=live). Led: one does.</summary>
    public enum HandState : uint { Own = 0, Free = 1, Led = 2 }

    /// <summary>How the force of an object is found.</summary>
    public enum ForceMethod : uint { Spm = 0, Paper = 1, Proxy = 2 }

    public sealed class ClientException : Exception
    {
        public ClientCode Code { get; }
        public ClientException(ClientCode code, string message) : base(message) { Code = code; }
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public struct OptionsData
    {
        public uint Size;
        public int TimeoutMs;
        [MarshalAs(UnmanagedType.LPStr)] public string Path;
        [MarshalAs(UnmanagedType.LPStr)] public string Name;
        [MarshalAs(UnmanagedType.LPStr)] public string Application;
        public ClientRole Role;
        public uint ServerUser;
        public uint Reconnect;
        public uint Reserved;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public struct InfoData
    {
        public uint Size;
        public uint Process;
        public double RateHz;
        public uint DeviceCount;
        public uint AssetCount;
        public uint ObjectCount;
        public uint CauseCount;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 32)] public string DaemonVersion;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 32)] public string LibraryVersion;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct TickData
    {
        public uint Size;
        public uint DeviceCount;
        public uint ObjectCount;
        /// <summary>Of the scene: as many as 64 are told.</summary>
        public uint ObjectTotal;
        public ulong Tick;
        public long TimeNs;
    }

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
        /// <summary>Where the surface holds the hand; the position without contact.</summary>
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Proxy;
        public double ForceCap;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] AngularVelocity;
        /// <summary>N m; 0: the device gives no torque.</summary>
        public double TorqueCap;
        public ClientLimits Limits;
        /// <summary>1: the hand holds an object of its own, the scene's [tool] asset.</summary>
        public uint HasTool;
        /// <summary>Places at which that tool touches: SpmClient.Contacts.</summary>
        public uint ContactCount;
        public uint Level;
        /// <summary>Objects that were found apart from the tool as a whole.</summary>
        public uint Culled;
        public HandState Hand;
        /// <summary>Of the tool's own frame as it lies in the scene.</summary>
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] ToolPosition;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] ToolOrientation;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] ProxyOrientation;
    }

    /// <summary>A place where a device's tool touches an object.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ContactData
    {
        public uint Size;
        public uint Device;
        public ulong Object;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Place;
        /// <summary>Unit, out of the object.</summary>
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Normal;
        /// <summary>N, on the tool.</summary>
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Force;
        public double Depth;
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

    [StructLayout(LayoutKind.Sequential)]
    public struct PoseData
    {
        public uint Size;
        public uint Reserved;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Position;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] Orientation;
        public double Period;
        public double Deadline;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct MaterialData
    {
        public uint Size;
        public MaterialFields Fields;
        public double Stiffness;
        public double FrictionStick;
        public double FrictionSlide;
        public double Damping;
        public double TextureAmplitude;
        public double TextureWavelength;
        public ulong TextureSeed;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct PushData
    {
        public uint Size;
        public uint Reserved;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Force;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Torque;
        public double Hold;
    }

    /// <summary>An effect on a hand; what its kind does not use is left at 0. MostForce and Range of
    /// 0: no limit. A Point or Axis that is null is zero.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct EffectData
    {
        public uint Size;
        public EffectKind Kind;
        public double Stiffness;
        public double Damping;
        public double MostForce;
        public double Range;
        public double Spacing;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Point;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Axis;
        public ulong Object;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct HandData
    {
        public uint Size;
        public uint Reserved;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Position;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] Orientation;
        public double Hold;
    }

    /// <summary>How an object feels now, before the limits of the device.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct FeelData
    {
        public uint Size;
        public ForceMethod Method;
        public uint Stabilized;
        public uint Reserved;
        public double Stiffness;
        public double FrictionStick;
        public double FrictionSlide;
        public double Damping;
        public double TextureAmplitude;
        public double TextureWavelength;
        public ulong TextureSeed;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct CommandCountsData
    {
        public uint Size;
        public uint LastRefusal;
        public ulong Sent;
        public ulong Taken;
        public ulong Refused;
        public ulong LastRefused;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct EventData
    {
        public uint Size;
        public EventKind Kind;
        public uint Device;
        public uint Value;
        public ulong Tick;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct LoopData
    {
        public uint Size;
        public uint Reserved;
        public long TimeNs;
        public ulong Ticks;
        public ulong Missed;
        public ulong Skipped;
        public ulong BusyNs;
        public ulong WakeMaxNs;
        public ulong BusyMaxNs;
        public ulong Taken;
        public ulong Refused;
        public ulong Garbage;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 64)] public ulong[] Wake;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 64)] public ulong[] Busy;
        public ulong Degraded;
        public ulong Held;
        public ulong Shortened;
        public ulong Coarse;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct DeviceCountsData
    {
        public uint Size;
        public uint LastCause;
        public ulong ContactTicks;
        public ulong CapHits;
        public ulong SlewHits;
        public double ForceMax;
        public double Energy;
        public double GeneratedMax;
        public ulong TorqueCapHits;
        public ulong TorqueSlewHits;
        public ulong ToolCapHits;
        public double TorqueMax;
    }

    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]
    public struct ApplicationData
    {
        public uint Size;
        public uint Connection;
        public uint Process;
        public ClientRole Role;
        [MarshalAs(UnmanagedType.ByValTStr, SizeConst = 64)] public string Name;
    }
}

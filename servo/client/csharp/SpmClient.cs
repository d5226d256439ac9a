// SPDX-License-Identifier: Apache-2.0
// libspm_client from C#, as Unity uses native libraries; README.md says what to copy where. World frame:
// right-handed, x to the right, y up, z towards the user, metres; Unity's z points away from the
// user, so negate z of positions and forces, and x and y of quaternions, on the way in and out.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Text;

namespace SpmHaptics
{
    /// <summary>A connection to spm-servo. Dispose it when the scene ends. What fails throws
    /// ClientException.</summary>
    public sealed class SpmClient : IDisposable
    {
        private const int NameBytes = 64;
        private const int PathBytes = 512;
        private const int MaxContacts = 16;
        /// <summary>ContactData.Object where the tool of another device is touched: this and that
        /// device's number.</summary>
        public const ulong ToolOfDevice = 1UL << 63;
        /// <summary>For RemoveEffect.</summary>
        public const uint AllEffects = uint.MaxValue;
        private IntPtr handle;

        /// <summary>name: of the daemon. serverUser: id of a user whose daemon is trusted, beside
        /// those of this user and of root. reconnect: a daemon that was restarted is found by the next
        /// call; until then calls throw with ClientCode.NoDaemon.</summary>
        public SpmClient(string path = null, string application = "unity", int timeoutMs = 1000,
                         ClientRole role = ClientRole.Application, uint serverUser = 0,
                         string name = null, bool reconnect = false)
        {
            var options = new OptionsData
            {
                Size = SizeOf<OptionsData>(),
                TimeoutMs = timeoutMs,
                Path = path,
                Name = name,
                Application = application,
                Role = role,
                ServerUser = serverUser,
                Reconnect = reconnect ? 1u : 0u
            };
            var message = new byte[512];
            var code = Library.spm_client_connect(ref options, out handle, message,
                                                  (UIntPtr)message.Length);
            if (code != ClientCode.Ok) throw new ClientException(code, TextOf(message));
        }

        public void Dispose()
        {
            if (handle != IntPtr.Zero) Library.spm_client_disconnect(handle);
            handle = IntPtr.Zero;
        }

        /// <summary>Looks for the daemon again where it is gone, once.</summary>
        public void Reconnect() { Check(Library.spm_client_reconnect(Open())); }

        /// <summary>Whether the daemon lives; age in s is how long ago its last tick was.</summary>
        public DaemonState State(out double age)
        {
            return Library.spm_client_daemon_state(Open(), out age);
        }

        public InfoData Info()
        {
            var data = new InfoData { Size = SizeOf<InfoData>() };
            Check(Library.spm_client_read_info(Open(), ref data));
            return data;
        }

        public string DeviceName(uint device)
        {
            var name = new byte[NameBytes];
            Check(Library.spm_client_device_name(Open(), device, name, (UIntPtr)name.Length));
            return TextOf(name);
        }

        public string AssetName(uint asset)
        {
            var name = new byte[NameBytes];
            Check(Library.spm_client_asset_name(Open(), asset, name, (UIntPtr)name.Length));
            return TextOf(name);
        }

        public string ObjectName(ulong id)
        {
            var name = new byte[NameBytes];
            Check(Library.spm_client_object_name(Open(), id, name, (UIntPtr)name.Length));
            return TextOf(name);
        }

        /// <summary>Why the force is zero and what to do about it; empty while there is force.</summary>
        public string CauseText(uint cause)
        {
            if (cause == 0) return "";
            IntPtr name, cure;
            Library.spm_client_cause(Open(), cause, out name, out cure);  // "" for an unknown one
            return Marshal.PtrToStringAnsi(name) + ": " + Marshal.PtrToStringAnsi(cure);
        }

        public DeviceData Device(uint device = 0)
        {
            var data = new DeviceData { Size = SizeOf<DeviceData>() };
            Check(Library.spm_client_read_device(Open(), device, ref data));
            return data;
        }

        /// <summary>Where the device's tool touches, the strongest places, of one tick.</summary>
        public List<ContactData> Contacts(uint device = 0)
        {
            var size = Marshal.SizeOf(typeof(ContactData));
            var tick = new TickData { Size = SizeOf<TickData>() };
            var memory = Marshal.AllocHGlobal(MaxContacts * size);
            try
            {
                Marshal.WriteInt32(memory, size);
                UIntPtr count;
                Check(Library.spm_client_read_contacts(Open(), device, ref tick, memory,
                                                       (UIntPtr)MaxContacts, out count));
                var contacts = new List<ContactData>();
                for (var i = 0; i < (int)count; ++i)
                {
                    contacts.Add((ContactData)Marshal.PtrToStructure(
                        IntPtr.Add(memory, i * size), typeof(ContactData)));
                }
                return contacts;
            }
            finally
            {
                Marshal.FreeHGlobal(memory);
            }
        }

        public ObjectData Object(ulong id)
        {
            var data = new ObjectData { Size = SizeOf<ObjectData>() };
            Check(Library.spm_client_read_object(Open(), id, ref data));
            return data;
        }

        /// <summary>Adds an object of an asset, orientation w x y z; returns its id. What the
        /// material does not give has the default of a scene.</summary>
        public ulong Add(uint asset, double[] position, double[] orientation, double scale = 1,
                         MaterialData material = default(MaterialData))
        {
            var pose = PoseOf(position, orientation, 0);
            material.Size = SizeOf<MaterialData>();
            ulong id;
            Check(Library.spm_client_add_object(Open(), asset, ref pose, scale, ref material,
                                                out id));
            return id;
        }

        /// <summary>Sends a pose, orientation w x y z; period, s, is the time to the next.</summary>
        public void Move(ulong id, double[] position, double[] orientation, double period)
        {
            var pose = PoseOf(position, orientation, period);
            Check(Library.spm_client_move_object(Open(), id, ref pose));
        }

        /// <summary>Puts an object to a pose at once, as if it were lifted and put down
        /// there.</summary>
        public void Place(ulong id, double[] position, double[] orientation)
        {
            var pose = PoseOf(position, orientation, 0);
            Check(Library.spm_client_place_object(Open(), id, ref pose));
        }

        /// <summary>Removes an object that this application added.</summary>
        public void Remove(ulong id) { Check(Library.spm_client_remove_object(Open(), id)); }

        public void SetMaterial(ulong id, MaterialData material)
        {
            material.Size = SizeOf<MaterialData>();
            Check(Library.spm_client_set_material(Open(), id, ref material));
        }

        /// <summary>While it is on, the hand moves freely and the tool stays.</summary>
        public void SetClutch(uint device, bool on)
        {
            Check(Library.spm_client_set_clutch(Open(), device, on ? 1 : 0));
        }

        /// <summary>Holds the device's force below this, N, while connected; never raises the
        /// daemon's cap.</summary>
        public void SetForceCap(uint device, double newtons)
        {
            Check(Library.spm_client_set_force_cap(Open(), device, newtons));
        }

        /// <summary>The method by which an object is felt. Paper needs a full asset.</summary>
        public void SetMethod(ulong id, ForceMethod method)
        {
            Check(Library.spm_client_set_method(Open(), id, method));
        }

        /// <summary>The scene's stabilization off or on, as a supervisor; without it a device may
        /// shake.</summary>
        public void Stabilize(bool on)
        {
            Check(Library.spm_client_stabilize(Open(), on ? 1 : 0));
        }

        /// <summary>Pushes the hand by a force, N, and a torque about the tool's origin, N m, for hold s
        /// (at most 1), in place of the last push. A device that gives no torque refuses one.</summary>
        public void Push(uint device, double[] force, double hold, double[] torque = null)
        {
            var push = new PushData
            {
                Size = SizeOf<PushData>(),
                Force = force,
                Torque = torque ?? new double[3],
                Hold = hold
            };
            Check(Library.spm_client_push_hand(Open(), device, ref push));
        }

        /// <summary>Sets an effect on the hand, or changes the one that has this number of one's own.
        /// It stays until it is removed or this application leaves.</summary>
        public void SetEffect(uint device, uint number, EffectData effect)
        {
            effect.Size = SizeOf<EffectData>();
            effect.Point = effect.Point ?? new double[3];
            effect.Axis = effect.Axis ?? new double[3];
            Check(Library.spm_client_set_effect(Open(), device, number, ref effect));
        }

        /// <summary>Removes one's own effect of that number, or all of one's own; a supervisor
        /// all.</summary>
        public void RemoveEffect(uint device, uint number = AllEffects)
        {
            Check(Library.spm_client_remove_effect(Open(), device, number));
        }

        /// <summary>Leads the hand of a simulated device (--device sim:hand=live), orientation w x y z;
        /// it is let go after hold s (at most 1) unless the next pose came. The loop refuses a hand that
        /// another application leads.</summary>
        public void LeadHand(uint device, double[] position, double[] orientation, double hold = 0.4)
        {
            var hand = new HandData
            {
                Size = SizeOf<HandData>(),
                Position = position,
                Orientation = orientation,
                Hold = hold
            };
            Check(Library.spm_client_lead_hand(Open(), device, ref hand));
        }

        /// <summary>Lets a hand go that this application leads: it is slack then.</summary>
        public void FreeHand(uint device)
        {
            Check(Library.spm_client_lead_hand(Open(), device, IntPtr.Zero));
        }

        /// <summary>How an object feels now.</summary>
        public FeelData Feel(ulong id)
        {
            var data = new FeelData { Size = SizeOf<FeelData>() };
            Check(Library.spm_client_read_feel(Open(), id, ref data));
            return data;
        }

        /// <summary>Where the daemon found an asset, absolute; empty where that is longer than it
        /// tells.</summary>
        public string AssetPath(uint asset)
        {
            var path = new byte[PathBytes];
            Check(Library.spm_client_asset_path(Open(), asset, path, (UIntPtr)path.Length));
            return TextOf(path);
        }

        /// <summary>N/m at which the device begins to shake, without and with stabilization, as the
        /// stability laboratory simulates it; 0: not known.</summary>
        public void Borders(uint device, out double bare, out double stabilized)
        {
            Check(Library.spm_client_border(Open(), device, out bare, out stabilized));
        }

        /// <summary>The cause of zero force after which Acknowledge is waited for.</summary>
        public const uint Unacknowledged = 14;

        /// <summary>Says that a fault is over, where the daemon waits for it (the cause
        /// unacknowledged).</summary>
        public void Acknowledge(uint device)
        {
            Check(Library.spm_client_acknowledge(Open(), device));
        }

        /// <summary>Waits for a tick after this one, at most timeout s; false if none came. Not for
        /// Unity's main thread.</summary>
        public bool WaitTick(ulong after, double timeout, out TickData tick)
        {
            tick = new TickData { Size = SizeOf<TickData>() };
            var code = Library.spm_client_wait_tick(Open(), after, timeout, ref tick);
            if (code == ClientCode.NotThere) return false;
            Check(code);
            return true;
        }

        /// <summary>How many commands were sent, taken and refused.</summary>
        public CommandCountsData Commands()
        {
            var data = new CommandCountsData { Size = SizeOf<CommandCountsData>() };
            Check(Library.spm_client_refusals(Open(), ref data));
            return data;
        }

        /// <summary>Why a command was refused, a sentence.</summary>
        public static string RefusalText(uint refusal)
        {
            return Marshal.PtrToStringAnsi(Library.spm_client_refusal(refusal));
        }

        /// <summary>The next change of a device since the last call; false if none.</summary>
        public bool NextEvent(out EventData next)
        {
            next = new EventData { Size = SizeOf<EventData>() };
            var code = Library.spm_client_next_event(Open(), ref next);
            if (code == ClientCode.NotThere || code == ClientCode.Busy) return false;
            Check(code);
            return true;
        }

        /// <summary>What the loop counted since it began; bucket i of Wake and Busy ends at
        /// BucketEnd(i).</summary>
        public LoopData Loop()
        {
            var data = new LoopData { Size = SizeOf<LoopData>() };
            Check(Library.spm_client_read_loop(Open(), ref data));
            return data;
        }

        /// <summary>ns.</summary>
        public static ulong BucketEnd(uint bucket) { return Library.spm_client_bucket_end(bucket); }

        /// <summary>What the loop counted for one device since it began.</summary>
        public DeviceCountsData DeviceCounts(uint device = 0)
        {
            var data = new DeviceCountsData { Size = SizeOf<DeviceCountsData>() };
            Check(Library.spm_client_read_device_counts(Open(), device, ref data));
            return data;
        }

        /// <summary>The applications that are connected; this one is among them.</summary>
        public List<ApplicationData> Applications()
        {
            var connected = new List<ApplicationData>();
            for (;;)
            {
                var data = new ApplicationData { Size = SizeOf<ApplicationData>() };
                var code = Library.spm_client_read_application(Open(), (uint)connected.Count,
                                                               ref data);
                if (code == ClientCode.NotThere) return connected;
                Check(code);
                connected.Add(data);
            }
        }

        private IntPtr Open()
        {
            if (handle == IntPtr.Zero) throw new ObjectDisposedException("SpmClient");
            return handle;
        }

        private static PoseData PoseOf(double[] position, double[] orientation, double period)
        {
            return new PoseData
            {
                Size = SizeOf<PoseData>(),
                Position = position,
                Orientation = orientation,
                Period = period
            };
        }

        private static uint SizeOf<T>() { return (uint)Marshal.SizeOf(typeof(T)); }

        private static void Check(ClientCode code)
        {
            if (code != ClientCode.Ok)
            {
                throw new ClientException(
                    code, Marshal.PtrToStringAnsi(Library.spm_client_text(code)));
            }
        }

        private static string TextOf(byte[] bytes)
        {
            int end = Array.IndexOf(bytes, (byte)0);
            return Encoding.UTF8.GetString(bytes, 0, end < 0 ? bytes.Length : end);
        }
    }
}

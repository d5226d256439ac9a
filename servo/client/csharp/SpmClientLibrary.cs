// SPDX-License-Identifier: Apache-2.0
// The functions of libspm_client, as spm_client.h declares them. Programs use SpmClient.cs.
using System;
using System.Runtime.InteropServices;

namespace SpmHaptics
{
    internal static class Library
    {
        private const string Name = "spm_client";

        [DllImport(Name)]
        internal static extern ClientCode spm_client_connect(
            ref OptionsData options, out IntPtr client, [Out] byte[] message, UIntPtr size);
        [DllImport(Name)]
        internal static extern void spm_client_disconnect(IntPtr client);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_reconnect(IntPtr client);
        [DllImport(Name)]
        internal static extern IntPtr spm_client_text(ClientCode code);
        [DllImport(Name)]
        internal static extern DaemonState spm_client_daemon_state(IntPtr client, out double age);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_read_info(IntPtr client, ref InfoData info);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_device_name(
            IntPtr client, uint device, [Out] byte[] name, UIntPtr size);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_asset_name(
            IntPtr client, uint asset, [Out] byte[] name, UIntPtr size);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_object_name(
            IntPtr client, ulong id, [Out] byte[] name, UIntPtr size);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_cause(
            IntPtr client, uint cause, out IntPtr name, out IntPtr cure);

        [DllImport(Name)]
        internal static extern ClientCode spm_client_read_device(
            IntPtr client, uint device, ref DeviceData data);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_read_contacts(
            IntPtr client, uint device, ref TickData tick, IntPtr contacts, UIntPtr max,
            out UIntPtr count);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_read_object(
            IntPtr client, ulong id, ref ObjectData data);

        [DllImport(Name)]
        internal static extern ClientCode spm_client_add_object(
            IntPtr client, uint asset, ref PoseData pose, double scale, ref MaterialData material,
            out ulong id);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_move_object(
            IntPtr client, ulong id, ref PoseData pose);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_place_object(
            IntPtr client, ulong id, ref PoseData pose);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_remove_object(IntPtr client, ulong id);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_set_material(
            IntPtr client, ulong id, ref MaterialData material);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_set_clutch(
            IntPtr client, uint device, int on);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_set_force_cap(
            IntPtr client, uint device, double newtons);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_set_method(
            IntPtr client, ulong id, ForceMethod method);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_stabilize(IntPtr client, int on);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_push_hand(
            IntPtr client, uint device, ref PushData push);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_set_effect(
            IntPtr client, uint device, uint number, ref EffectData effect);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_remove_effect(
            IntPtr client, uint device, uint number);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_acknowledge(IntPtr client, uint device);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_lead_hand(
            IntPtr client, uint device, ref HandData hand);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_lead_hand(
            IntPtr client, uint device, IntPtr none);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_read_feel(
            IntPtr client, ulong id, ref FeelData feel);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_asset_path(
            IntPtr client, uint asset, [Out] byte[] path, UIntPtr size);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_border(
            IntPtr client, uint device, out double bare, out double stabilized);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_wait_tick(
            IntPtr client, ulong after, double timeout, ref TickData tick);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_refusals(
            IntPtr client, ref CommandCountsData counts);
        [DllImport(Name)]
        internal static extern IntPtr spm_client_refusal(uint refusal);

        [DllImport(Name)]
        internal static extern ClientCode spm_client_next_event(IntPtr client, ref EventData next);

        [DllImport(Name)]
        internal static extern ClientCode spm_client_read_loop(IntPtr client, ref LoopData loop);
        [DllImport(Name)]
        internal static extern ulong spm_client_bucket_end(uint bucket);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_read_device_counts(
            IntPtr client, uint device, ref DeviceCountsData counts);
        [DllImport(Name)]
        internal static extern ClientCode spm_client_read_application(
            IntPtr client, uint index, ref ApplicationData application);
    }
}

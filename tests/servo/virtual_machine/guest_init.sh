#!/bin/busybox sh
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=dash
# The first process of the virtual machine: plugs in one emulated device after the other, runs the
# daemon on it, tells what came of it at the second serial port, and switches the machine off.
# Each line told is a word and what belongs to it; check_cases.py judges them.
export PATH=/bin:/usr/bin HOME=/root
/bin/busybox --install -s /bin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
mkdir -p /dev/shm /run /tmp /root
mount -t tmpfs shm /dev/shm
mount -t tmpfs run /run
stty -F /dev/ttyS1 raw
exec 3> /dev/ttyS1

say() {
  echo "$*" >&3
}

tell() { # WORD FILE: each line of it
  while IFS= read -r line; do say "$1 $line"; done < "$2"
}

wait_until() {
  for _ in $(seq 100); do
    "$@" && return
    sleep 0.1
  done
  say "message waited in vain until: $*"
}

is_plugged_in() { # PRODUCT: and configured
  for folder in /sys/bus/usb/devices/*; do
    [ "$(cat "$folder/idProduct" 2> /dev/null)" = "$1" ] &&
      [ -n "$(cat "$folder/bConfigurationValue")" ] && return
  done
  return 1
}

serve() { # NAME SECONDS DEVICE SCENE
  say "case $1"
  spm-servo devices --json > /run/devices 2>&1
  tell devices /run/devices
  timeout -s KILL 90 spm-servo run --device "$3" --scene "/haptics/$4.toml" --duration "$2" --realtime require --json \
    > /run/report 2> /run/messages
  say "exit $?"
  tell report /run/report
  tell message /run/messages
}

finish() { # PROCESS: of the emulated device
  kill "$1"
  wait "$1"
  say "emulator $?"
  tell message /run/emulator
  tell seen /run/seen
  rm -f /run/seen
  say end
}

wooden() { # NAME SECONDS SCENE BOARD [OPTION...]
  name=$1 seconds=$2 scene=$3
  shift 3
  uhid_wooden "$@" report=/run/seen 2> /run/emulator &
  emulator=$!
  wait_until test -c /dev/hidraw0
  serve "$name" "$seconds" woodenhaptics:home_confirmed=always,signs=+++ "$scene"
  finish $emulator
}

falcon() { # NAME SECONDS [OPTION...]
  name=$1 seconds=$2
  shift 2
  usbip_falcon "$@" report=/run/seen 2> /run/emulator &
  emulator=$!
  wait_until is_plugged_in cb48
  serve "$name" "$seconds" falcon:firmware=/haptics/firmware.bin falcon
  finish $emulator
}

ftdi_driver() { # WHEN: whether the kernel's own driver has QEMU's chip
  if [ -c /dev/ttyUSB0 ]; then say "driver_$1 true"; else say "driver_$1 false"; fi
}

while read -r module; do
  insmod "/modules/$module" || say "message the module $module is not taken"
done < /modules/order

wooden uhid_v1 2 product wooden-v1
wooden uhid_v2 2 wooden wooden-v2
wooden uhid_v3 2 wooden wooden-v3
wooden uhid_replug 4 wooden wooden-v2 unplug=500:300 times=3
falcon usbip 3
falcon usbip_replug 4 unplug=600:300 times=2
falcon usbip_power 5 unplug=600:300 power=lost

wait_until test -c /dev/ttyUSB0
ftdi_driver before
serve ftdi 3 falcon:product=6001,firmware=/haptics/firmware.bin falcon
sleep 0.5
ftdi_driver after
say end

say "done"
poweroff -f

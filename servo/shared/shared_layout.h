/* SPDX-License-Identifier: Apache-2.0 */
/** The memory that the daemon and its clients share. Internal to both: programs use spm_client.h.
 *
 *  There are two kinds of regions, so that a client that writes garbage harms only itself:
 *  - spm_shared_state, one for all, which clients map read-only: what the loop publishes each tick;
 *  - spm_shared_ring, one for each client, which that client and the daemon map for writing:
 *    commands.
 *
 *  There are no pointers, only fixed-width types, and no padding that the compiler chooses. Every
 *  field is read and written by shared_words.hpp, as atomic words. A change of this file that moves
 *  a field, or gives one another meaning, raises SPM_LAYOUT_VERSION: daemon and library of
 * different layouts refuse each other with a sentence. Lengths are in metres, forces in newtons,
 * torques in newton metres, times of CLOCK_MONOTONIC in nanoseconds, quaternions are unit with w
 * first, all in the world frame. */
#ifndef SPM_SHARED_LAYOUT_H
#define SPM_SHARED_LAYOUT_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#define SPM_LAYOUT_ASSERT static_assert
#else
#include <stddef.h>
#include <stdint.h>
#define SPM_LAYOUT_ASSERT _Static_assert
#endif

#define SPM_LAYOUT_VERSION 8u

#define SPM_STATE_MAGIC UINT64_C(0x65746174534d5053) /* the bytes SPMState */
#define SPM_RING_MAGIC UINT64_C(0x676e6952204d5053)  /* the bytes SPM Ring */

/* Object of a contact with the tool of another device: this and that device's number. */
#define SPM_TOOL_OF_DEVICE (UINT64_C(1) << 63)

enum {
  SPM_MAX_DEVICES = 8,
  SPM_MAX_OBJECTS = 64,
  SPM_MAX_ASSETS = 32,
  SPM_MAX_CAUSES = 32,
  SPM_MAX_APPLICATIONS = 16, /* in the role of an application */
  SPM_MAX_CLIENTS = 20,      /* four places more for supervisors and observers */
  SPM_MAX_CONTACTS = 16,     /* of each device's tool */
  SPM_NAME_BYTES = 64,       /* of every name, including its closing zero */
  SPM_CURE_BYTES = 192,
  SPM_PATH_BYTES = 512, /* of an asset's file, including its closing zero */
  SPM_VERSION_BYTES = 32,
  SPM_BUCKETS = 64,    /* of durations: shared_buckets.hpp */
  SPM_RING_SLOTS = 256 /* a power of two: four frames of the largest number of objects */
};

/* Bits of spm_shared_device.flags. */
enum {
  SPM_DEVICE_CONNECTED = 1,
  SPM_DEVICE_CONTACT = 2,
  SPM_DEVICE_FORCE_CAPPED = 4,  /* what was sent met its cap */
  SPM_DEVICE_TORQUE_CAPPED = 8, /* the same */
  SPM_DEVICE_TOOL_CAPPED = 16,  /* the coupling of hand and tool met its cap */
  SPM_DEVICE_TOOL = 32,         /* the hand holds a tool, whose pose is known */
  SPM_DEVICE_LEADABLE = 64,     /* an application may lead its hand */
  SPM_DEVICE_LED = 128          /* one does */
};

/** One device in one tick. */
typedef struct spm_shared_device {
  double position[3];
  double orientation[4];
  double velocity[3]; /* m/s */
  double force[3];    /* on the hand, as sent */
  double torque[3];   /* about the tool's origin, as sent */
  double depth;
  uint32_t buttons;
  uint32_t cause;  /* of zero force: row of spm_shared_info.causes */
  uint32_t health; /* spm::servo::DeviceHealth */
  uint32_t flags;
  uint32_t contacts;          /* how often contact began */
  uint32_t cuts;              /* how often the force was cut to zero */
  double proxy[3];            /* where the surface holds the tool; the position without contact */
  double force_cap;           /* N, that holds now; infinity: none */
  double angular_velocity[3]; /* rad/s */
  double torque_cap;          /* N m; 0: the device gives no torque; infinity: none */
  double tool_position[3];    /* of the tool's frame, with SPM_DEVICE_TOOL */
  double tool_orientation[4];
  double proxy_orientation[4];
  uint32_t contact_count; /* of spm_shared_snapshot.contacts */
  uint32_t level;         /* of the tool's samples, coarser than the finest */
  uint32_t culled;        /* objects that were found apart from the tool as a whole */
  uint32_t reserved;
} spm_shared_device;

/** A place where a device's tool touches an object. */
typedef struct spm_shared_contact {
  uint64_t object; /* id */
  double place[3];
  double normal[3]; /* unit, out of the object */
  double force[3];  /* on the tool */
  double depth;
} spm_shared_contact;

/* Bits of spm_shared_object.flags. */
enum { SPM_OBJECT_MOVABLE = 1, SPM_OBJECT_CONTACT = 2, SPM_OBJECT_DRIVEN = 4 };

/** One object in one tick. */
typedef struct spm_shared_object {
  uint64_t id; /* the connection that added it (0: the scene) times 2^32, plus a number */
  double position[3];
  double orientation[4];
  double scale;
  double force[3];  /* reaction: what the tools did to it */
  double torque[3]; /* about the object's origin */
  double silent;    /* s since the last pose from an application */
  uint32_t asset;
  uint32_t flags;
  double stiffness; /* N/m, as it was asked for, before the device's limits */
  double friction_stick;
  double friction_slide;
  double damping;           /* N s/m */
  double texture_amplitude; /* m */
  double texture_wavelength;
  uint64_t texture_seed;
  uint32_t method; /* spm::Method */
  uint32_t stabilized;
} spm_shared_object;

/** One tick. Two of these are written in turn, each behind a sequence lock. A reader copies the one
 *  that was finished last, and has a whole tick for it before the loop writes to that one again. */
typedef struct spm_shared_snapshot {
  uint64_t sequence; /* odd while it is written */
  uint64_t tick;
  int64_t time_ns;
  uint32_t device_count;
  uint32_t object_count;
  uint64_t object_total; /* of the scene, of which object_count are published */
  uint64_t reserved[3];
  spm_shared_device devices[SPM_MAX_DEVICES];
  spm_shared_object objects[SPM_MAX_OBJECTS];
  spm_shared_contact contacts[SPM_MAX_DEVICES][SPM_MAX_CONTACTS];
} spm_shared_snapshot;

/** A cause of zero force in words, so that a library knows the causes of a newer daemon. */
typedef struct spm_shared_cause {
  char name[SPM_NAME_BYTES];
  char cure[SPM_CURE_BYTES];
} spm_shared_cause;

/** Names, which seldom change; all are closed by a zero. Behind a sequence lock of its own. */
typedef struct spm_shared_info {
  uint32_t device_count;
  uint32_t asset_count;
  uint32_t object_count; /* of the scene; added objects have no name */
  uint32_t cause_count;
  char devices[SPM_MAX_DEVICES][SPM_NAME_BYTES];
  char assets[SPM_MAX_ASSETS][SPM_NAME_BYTES];
  char objects[SPM_MAX_OBJECTS][SPM_NAME_BYTES];
  spm_shared_cause causes[SPM_MAX_CAUSES];
  char asset_paths[SPM_MAX_ASSETS][SPM_PATH_BYTES]; /* absolute; empty where it is longer */
  /* N/m of the scene at which each device begins to shake, by simulation; 0: not known */
  double bare_borders[SPM_MAX_DEVICES]; /* a flat wall without stabilization */
  double stabilized_borders[SPM_MAX_DEVICES];
} spm_shared_info;

/** What the loop counted for one device since it began. */
typedef struct spm_shared_device_counts {
  uint64_t contact_ticks;
  uint64_t cap_hits;
  uint64_t slew_hits;
  double force_max;     /* as sent */
  double energy;        /* J, net work on the hand of what was sent */
  double generated_max; /* J, largest positive value of energy */
  uint32_t last_cause;  /* the last cause of zero force; 0: none so far */
  uint32_t reserved;
  uint64_t torque_cap_hits;
  uint64_t torque_slew_hits;
  uint64_t tool_cap_hits; /* in which the coupling of hand and tool met its cap */
  double torque_max;      /* N m, as sent */
} spm_shared_device_counts;

/** What the loop counted since it began; written a tick later than its snapshots. Behind a sequence
 *  lock of its own. */
typedef struct spm_shared_loop {
  uint64_t sequence;
  int64_t time_ns; /* when the last tick that is counted began */
  uint64_t ticks;
  uint64_t missed;  /* not finished before the next one was due, including skipped ones */
  uint64_t skipped; /* missed ticks that were not run at all */
  uint64_t busy_ns; /* sum */
  uint64_t wake_max_ns;
  uint64_t busy_max_ns;
  uint64_t taken; /* commands of all applications */
  uint64_t refused;
  uint64_t garbage;
  uint32_t device_count;
  uint32_t reserved;
  uint64_t degraded;  /* ticks that had too little time for all objects; 0 from older daemons */
  uint64_t held;      /* answers of objects that were coarser by that: spm::Care */
  uint64_t shortened; /* the same */
  uint64_t coarse;    /* ticks of devices at a coarser level of the tool's samples */
  uint64_t wake[SPM_BUCKETS]; /* ticks by how late they began */
  uint64_t busy[SPM_BUCKETS]; /* ticks by how long they worked */
  spm_shared_device_counts devices[SPM_MAX_DEVICES];
} spm_shared_loop;

/** A client, as the others see it. */
typedef struct spm_shared_application {
  uint32_t connection;
  uint32_t process;
  char name[SPM_NAME_BYTES]; /* its own name for itself, printable ASCII */
} spm_shared_application;

/** Who is connected. Behind a sequence lock of its own; the loop does not use it. */
typedef struct spm_shared_applications {
  uint64_t sequence;
  uint32_t count;
  uint32_t supervisors; /* bit i: list[i] has the role of a supervisor */
  uint32_t observers;   /* the same, of an observer */
  uint32_t reserved;
  spm_shared_application list[SPM_MAX_CLIENTS];
} spm_shared_applications;

/** The region that all clients map read-only. */
typedef struct spm_shared_state {
  uint64_t magic;
  uint32_t layout_version;
  uint32_t bytes;
  char daemon_version[SPM_VERSION_BYTES];
  uint32_t process; /* the daemon's */
  uint32_t reserved;
  double rate_hz;
  int64_t heartbeat_ns; /* the loop's last tick */
  uint64_t published;   /* snapshots so far; the newest is at index (published - 1) & 1 */
  uint64_t ended;       /* 1 once the daemon ended in order */
  uint64_t info_sequence;
  uint64_t more_reserved[4];
  spm_shared_snapshot snapshots[2];
  spm_shared_info info;
  spm_shared_loop loop;
  spm_shared_applications applications;
} spm_shared_state;

/* Kinds of commands. */
enum {
  SPM_COMMAND_ADD = 1,
  SPM_COMMAND_MOVE = 2,
  SPM_COMMAND_REMOVE = 3,
  SPM_COMMAND_MATERIAL = 4,
  SPM_COMMAND_CLUTCH = 5,
  SPM_COMMAND_FORCE_CAP = 6,
  SPM_COMMAND_PUSH = 7,
  SPM_COMMAND_EFFECT = 8,
  SPM_COMMAND_REMOVE_EFFECT = 9,
  SPM_COMMAND_LEAD = 10,
  SPM_COMMAND_METHOD = 11,
  SPM_COMMAND_STABILIZE = 12,
  SPM_COMMAND_PLACE = 13, /* as MOVE, but at once */
  SPM_COMMAND_ACKNOWLEDGE = 16
};

/* spm_shared_command.effect_kind. */
enum {
  SPM_EFFECT_SPRING = 1,
  SPM_EFFECT_VISCOUS = 2,
  SPM_EFFECT_MAGNET = 3,
  SPM_EFFECT_DETENTS = 4
};

/* spm_shared_command.effect of REMOVE_EFFECT: all of the device. */
#define SPM_ALL_EFFECTS UINT32_MAX

/* Bits of spm_shared_command.fields: which parts of the material are set. */
enum {
  SPM_MATERIAL_STIFFNESS = 1,
  SPM_MATERIAL_FRICTION = 2,
  SPM_MATERIAL_DAMPING = 4,
  SPM_MATERIAL_TEXTURE = 8,
  SPM_MATERIAL_ALL = 15
};

/** One command. The daemon checks everything in it before use (app_command.hpp). */
typedef struct spm_shared_command {
  uint64_t sequence; /* 1 for a ring's first command, and so on */
  uint32_t kind;
  /* ADD: asset; CLUTCH, FORCE_CAP, PUSH, ACKNOWLEDGE, LEAD, effects: device; METHOD: 0 spm, 1
   * paper, 2 proxy */
  uint32_t index;
  uint64_t object;     /* that is meant; EFFECT: the magnet's */
  int64_t deadline_ns; /* later than this it is refused; 0: never */
  double position[3];  /* EFFECT: the spring's point, or one of the detents */
  double orientation[4];
  double scale;  /* ADD */
  double period; /* MOVE: s to the next pose, a hint; 0: not known */
  double stiffness;
  double friction_stick;
  double friction_slide;
  double damping;
  double texture_amplitude;
  double texture_wavelength;
  uint64_t texture_seed;
  uint32_t fields; /* ADD and MATERIAL */
  /* CLUTCH: 1 holds the scene while the hand moves freely; LEAD: 0 lets go; STABILIZE: 0 or 1 */
  uint32_t on;
  double force_cap; /* FORCE_CAP: N */
  uint64_t reserved[2];
  double force[3];      /* PUSH: N */
  double torque[3];     /* PUSH: N m, about the tool's origin */
  double hold;          /* PUSH, LEAD: s */
  double axis[3];       /* EFFECT: of detents, unit */
  double most_force;    /* EFFECT: N; 0: no limit */
  double range;         /* EFFECT: m; 0: no limit */
  double spacing;       /* EFFECT: m, of detents */
  uint32_t effect;      /* the client's number for an effect */
  uint32_t effect_kind; /* EFFECT */
} spm_shared_command;

/** A client's region: commands from the one thread that writes them to the loop. */
typedef struct spm_shared_ring {
  uint64_t magic;
  uint32_t layout_version;
  uint32_t bytes;
  uint64_t reserved[6];
  uint64_t head;  /* by the client: commands written so far */
  uint64_t calls; /* by the client: changes with every reading of the state, a sign of life */
  uint64_t more_reserved[6];
  uint64_t tail; /* by the daemon, which never reads it back: commands taken so far */
  uint64_t refused;
  uint64_t garbage;      /* heads and sequence numbers that made no sense */
  uint64_t last_refused; /* its sequence number */
  uint64_t last_refusal; /* why: spm::servo::Refusal */
  uint64_t still_more_reserved[3];
  spm_shared_command slots[SPM_RING_SLOTS];
} spm_shared_ring;

SPM_LAYOUT_ASSERT(sizeof(double) == 8, "doubles of 64 bits");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_device) == 328, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_device, buttons) == 136, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_device, force_cap) == 184, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_device, contact_count) == 312, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_contact) == 88, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_object) == 200, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_object, silent) == 120, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_snapshot) == 64 + 8 * 328 + 64 * 200 + 128 * 88, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_snapshot, devices) == 64, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_snapshot, objects) == 2688, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_cause) == 256, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_info) == 16 + (8 + 32 + 64) * 64 + 32 * 256 + 32 * 512 + 8 * 16,
                  "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_state, rate_hz) == 56, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_state, heartbeat_ns) == 64, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_state, snapshots) == 128, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_state, info) == 128 + 2 * 26752, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_device_counts) == 88, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_loop, wake) == 128, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_loop, devices) == 128 + 2 * 64 * 8, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_loop) == 128 + 2 * 64 * 8 + 8 * 88, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_application) == 72, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_applications) == 24 + 20 * 72, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_state, loop) == 128 + 2 * 26752 + 31376, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_state, applications) == 85008 + 1856, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_state) == 85008 + 1856 + 1464, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_command) == 304, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_command, texture_seed) == 152, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_command, force) == 192, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_ring, head) == 64, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_ring, tail) == 128, "layout");
SPM_LAYOUT_ASSERT(offsetof(spm_shared_ring, slots) == 192, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_shared_ring) == 192 + 256 * 304, "layout");
SPM_LAYOUT_ASSERT((SPM_RING_SLOTS & (SPM_RING_SLOTS - 1)) == 0, "a power of two");

#endif

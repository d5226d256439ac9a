/* SPDX-License-Identifier: Apache-2.0 */
/** libspm_client: for applications beside the daemon `spm-servo run`. The daemon computes the force
 *  beside the device; the application reads what the hand does, moves the objects of the scene and
 *  changes how they feel, at its own pace.
 *
 *  Reading copies from shared memory, without a lock or a system call, and never makes the daemon
 *  wait. Commands go into a ring, which the daemon empties each tick; it checks every number.
 *  spm_client_refusals reports commands that it could not follow. Whatever the application does,
 *  the loop keeps its tick.
 *
 *  Reading and commands are signs of life. If an application that moves objects gives none for a
 *  second while it stays connected, it is taken to hang. The scene is held for that second; then
 *  the force fades out over half a second (SPM_CLIENT_OFF_APPLICATION_SILENT), and its effects
 *  fade. They fade in again with the application's next call. An application that still reads, but
 *  has moved nothing for a second, and left an object or an effect's point amid its motion (faster
 *  than 20 mm/s or 0.2 rad/s), is taken to hang as well, until it moves something again: give an
 *  object's last pose twice when it stops.
 *
 *  No command is felt as a knock. What it changes goes over in 0.15 s or more, so that the force
 *  changes by at most 60 N/s for it: materials, effects, pushes, the force cap, and objects that
 * are added, removed or placed where a hand touches them. What is set to what it is already is not
 * felt at all.
 *
 *  Positions are in metres, forces in newtons, torques in newton metres, quaternions are unit with
 *  w first (w x y z), all in the world frame: x to the right, y up, z towards the user. Every
 *  struct begins with its size, which the caller sets (`spm_client_device d = {.size = sizeof
 * d};`); fields are only ever added at the end. Any thread may call any function, except
 *  spm_client_disconnect, which must be the last call. Functions return SPM_CLIENT_OK or what was
 *  wrong. */
#ifndef SPM_CLIENT_H
#define SPM_CLIENT_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define SPM_CLIENT_API __attribute__((visibility("default")))
#else
#define SPM_CLIENT_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define SPM_CLIENT_VERSION 1

/** Names and texts fit into this many bytes, including their closing zero. */
#define SPM_CLIENT_NAME_BYTES 64

typedef struct spm_client spm_client;

enum spm_client_code {
  SPM_CLIENT_OK = 0,
  SPM_CLIENT_BAD_ARGUMENT = 1, /**< a null pointer, a size that no version had, a wrong name */
  SPM_CLIENT_NO_DAEMON = 2,    /**< none answers there, or it no longer answers */
  SPM_CLIENT_REFUSED = 3,  /**< the daemon does not want this application; the message says why */
  SPM_CLIENT_INTERNAL = 4, /**< no memory, or a defect */
  SPM_CLIENT_VERSION_DIFFERS = 5, /**< daemon and library do not belong together */
  SPM_CLIENT_RING_FULL = 6, /**< the daemon has not yet come to earlier commands: try again later */
  SPM_CLIENT_BUSY = 7,      /**< the state changed under the reader too often: try again */
  SPM_CLIENT_NOT_THERE = 8, /**< no such device, object, asset or cause, or no tick so far */
  SPM_CLIENT_NOT_MOVABLE = 9 /**< the scene says that the object stays where it is */
};

/** What a code means: a sentence, never NULL. For the code that this thread's last call returned it
 *  names the argument that was wrong and its limits. Valid until the thread's next call. */
SPM_CLIENT_API const char* spm_client_text(int code);

enum spm_client_daemon {
  SPM_CLIENT_RUNNING = 0, /**< the loop ticks */
  SPM_CLIENT_STALLED = 1, /**< no tick for 0.1 s: the loop was not begun, is stopped, or hangs */
  SPM_CLIENT_ENDED = 2,   /**< the daemon ended in order */
  SPM_CLIENT_GONE = 3     /**< the daemon hung up without a word: it crashed or was killed */
};

/** Why the force is zero. A newer daemon may have further causes; their names and cures come from
 *  the daemon: spm_client_cause. */
enum spm_client_force_off {
  SPM_CLIENT_FORCE_ON = 0,
  SPM_CLIENT_OFF_STARTING = 1,
  SPM_CLIENT_OFF_ASSET_LOST = 2,
  SPM_CLIENT_OFF_NOT_A_NUMBER = 3,
  SPM_CLIENT_OFF_DEVICE_FAULT = 4,
  SPM_CLIENT_OFF_STOPPING = 5,
  SPM_CLIENT_OFF_DEVICE_SILENT = 6,
  SPM_CLIENT_OFF_DEVICE_GONE = 7,
  SPM_CLIENT_OFF_NOT_HOMED = 8,
  SPM_CLIENT_OFF_JUMPED = 9,
  SPM_CLIENT_OFF_CLUTCHED = 10,
  SPM_CLIENT_OFF_OUTSIDE_WORKSPACE = 11,
  SPM_CLIENT_OFF_APPLICATION_SILENT = 12,
  SPM_CLIENT_OFF_STALLED = 13,
  SPM_CLIENT_OFF_UNACKNOWLEDGED = 14, /**< a fault is over: spm_client_acknowledge */
  SPM_CLIENT_OFF_NOT_ENABLED = 15,    /**< the enable switch of the device is not held */
  SPM_CLIENT_OFF_RUNAWAY = 16,    /**< the device pushes the wrong way: spm_client_acknowledge */
  SPM_CLIENT_OFF_UNCONFIRMED = 17 /**< nobody has confirmed the device's signs yet */
};

enum spm_client_health {
  SPM_CLIENT_HEALTH_OK = 0,
  SPM_CLIENT_HEALTH_FAULT = 1,
  SPM_CLIENT_HEALTH_SILENT = 2,
  SPM_CLIENT_HEALTH_GONE = 3,
  SPM_CLIENT_HEALTH_NOT_HOMED = 4,
  SPM_CLIENT_HEALTH_UNCONFIRMED = 5 /**< its pose is told, but nobody has confirmed its signs */
};

/* --- Connecting ------------------------------------------------------------------------------ */

/** An object or an effect belongs to the application that added it; one of the scene to the first
 * that moves or changes it; a clutch to who took it: until that application leaves, what another
 * asks for there is refused. A supervisor may move and change any object, remove any that an
 * application added, and take any clutch. The daemon allows the role to its own user and to root
 * alone. An observer reads alone: the loop refuses all of its commands. There are 16 places for
 * applications, which neither a supervisor nor an observer takes: those have four more. */
enum spm_client_role {
  SPM_CLIENT_APPLICATION = 0,
  SPM_CLIENT_SUPERVISOR = 1,
  SPM_CLIENT_OBSERVER = 2
};

typedef struct spm_client_options {
  uint32_t size;
  int32_t timeout_ms;      /**< how long to wait for the daemon's answer; 0: 1000 */
  const char* path;        /**< of the socket; NULL: that of `name` */
  const char* name;        /**< of the daemon; NULL: $SPM_SERVO_NAME, or "default" */
  const char* application; /**< what the daemon's `top` calls this application; may be NULL */
  uint32_t role;           /**< enum spm_client_role */
  uint32_t server_user;    /**< id of a user whose daemon is trusted, beside those of this user and
                                of root; 0: nobody else */
  uint32_t reconnect;      /**< 1: where the daemon is gone, each call looks for it again, at most
                                every 20 ms, and returns SPM_CLIENT_NO_DAEMON until it is back */
  uint32_t reserved;
} spm_client_options;

/** Connects; `options` may be NULL. A daemon of another user is not spoken to, unless it is root's
 *  or that of `server_user`; nor is a socket in a folder that others could write to. Returns
 * SPM_CLIENT_OK and sets *client. On an error it writes one sentence to `message` (which may be
 * NULL), cut to `message_size` bytes with its closing zero: what is wrong with the daemon, and the
 * cure. */
SPM_CLIENT_API int spm_client_connect(const spm_client_options* options, spm_client** client,
                                      char* message, size_t message_size);

/** Looks for the daemon again where it is gone, once. SPM_CLIENT_OK also where it never went. What
 *  the application had added and set there is gone: objects get new ids. */
SPM_CLIENT_API int spm_client_reconnect(spm_client* client);

/** Disconnects; NULL is allowed. The objects and effects that the application added are
 *  removed, and its pushes end. */
SPM_CLIENT_API void spm_client_disconnect(spm_client* client);

/** Whether the daemon lives: enum spm_client_daemon. `age` (s, may be NULL) is how long ago the
 *  loop's last tick was, -1 before the first. One system call. */
SPM_CLIENT_API int spm_client_daemon_state(const spm_client* client, double* age);

typedef struct spm_client_info {
  uint32_t size;
  uint32_t process; /**< the daemon's */
  double rate_hz;
  uint32_t device_count;
  uint32_t asset_count;
  uint32_t object_count; /**< of the scene; their ids are 0, 1, ... */
  uint32_t cause_count;
  char daemon_version[32];
  char library_version[32];
} spm_client_info;

SPM_CLIENT_API int spm_client_read_info(const spm_client* client, spm_client_info* info);

/** Names, cut to `size` with the closing zero. */
SPM_CLIENT_API int spm_client_device_name(const spm_client* client, uint32_t device, char* name,
                                          size_t size);
SPM_CLIENT_API int spm_client_asset_name(const spm_client* client, uint32_t asset, char* name,
                                         size_t size);
SPM_CLIENT_API int spm_client_object_name(const spm_client* client, uint64_t object, char* name,
                                          size_t size);

/** The name of a cause of zero force (such as "device_gone") and what to do about it. The texts are
 *  valid as long as the connection; an unknown cause gives "" for both. */
SPM_CLIENT_API int spm_client_cause(const spm_client* client, uint32_t cause, const char** name,
                                    const char** cure);

/* --- Reading ---------------------------------------------------------------------------------- */

/** When a state was published. */
typedef struct spm_client_tick {
  uint32_t size;
  uint32_t device_count;
  uint32_t object_count;
  uint32_t object_total; /**< of the scene: as many as 64 are told */
  uint64_t tick;         /**< index on the loop's time grid */
  int64_t time_ns;       /**< of CLOCK_MONOTONIC */
} spm_client_tick;

/** One device. */
typedef struct spm_client_device {
  uint32_t size;
  uint32_t connected;    /**< 0 while it is unplugged */
  uint64_t tick;         /**< the tick of the other fields */
  double position[3];    /**< of the tool's origin */
  double orientation[4]; /**< of the tool */
  double velocity[3];    /**< m/s */
  double force[3];       /**< on the hand, as sent to the device */
  double torque[3];      /**< about the tool's origin, as sent */
  double depth;          /**< m, in the object that it presses deepest; 0 or more */
  uint32_t contact;      /**< 1 while it touches */
  uint32_t buttons;      /**< one bit for each button */
  uint32_t cause;        /**< of zero force: enum spm_client_force_off */
  uint32_t health;       /**< enum spm_client_health */
  uint32_t contacts;     /**< how often contact has begun: none is missed between two reads */
  uint32_t cuts;         /**< how often the force was cut to zero */
  double proxy[3];       /**< m, where the surface holds the tool, in the object that it presses
                              deepest: the proxy of the method `proxy`, otherwise the place on the
                              surface that the force points to; the position without contact */
  double force_cap;      /**< N, that holds now; infinity: none */
  double angular_velocity[3]; /**< rad/s */
  double torque_cap;      /**< N m, that holds now; 0: the device gives no torque; infinity: none */
  uint32_t limits;        /**< enum spm_client_limit, added up: which were met in that tick */
  uint32_t has_tool;      /**< 1: the hand holds an object of its own, the scene's `[tool] asset` */
  uint32_t contact_count; /**< places at which that tool touches: spm_client_read_contacts */
  uint32_t level;         /**< levels by which its samples were coarser than the finest */
  uint32_t culled;        /**< objects that were found apart from the tool as a whole */
  uint32_t hand;          /**< enum spm_client_hand_state, spm_client_live.h */
  double tool_position[3]; /**< m, of the tool's own frame as it lies in the scene: draw it there */
  double tool_orientation[4];  /**< of the same */
  double proxy_orientation[4]; /**< with `proxy`, which with a tool is where the hand would be that
                                    held the tool where it is; else the orientation */
} spm_client_device;

/** Limits that a tick met. */
enum spm_client_limit {
  SPM_CLIENT_FORCE_CAP_MET = 1,  /**< the force that was sent */
  SPM_CLIENT_TORQUE_CAP_MET = 2, /**< the torque that was sent */
  SPM_CLIENT_TOOL_CAP_MET = 4    /**< the coupling of hand and tool: the tool stays behind */
};

/** Contact's object where the tool of another device is touched: this and that device's number. */
#define SPM_CLIENT_TOOL_OF_DEVICE (UINT64_C(1) << 63)

/** A place where a device's tool, ball or point touches an object. */
typedef struct spm_client_contact {
  uint32_t size;
  uint32_t device;
  uint64_t object;  /**< id, or SPM_CLIENT_TOOL_OF_DEVICE and a device's number */
  double place[3];  /**< m, the middle of the pressure */
  double normal[3]; /**< unit, out of the object */
  double force[3];  /**< N, on the tool */
  double depth;     /**< m, the deepest place */
} spm_client_contact;

#define SPM_CLIENT_MAX_CONTACTS 16

/** One object of the scene. */
typedef struct spm_client_object {
  uint32_t size;
  uint32_t asset;
  uint64_t id;
  uint64_t tick; /**< the tick of the other fields */
  double position[3];
  double orientation[4];
  double scale;
  double force[3];  /**< reaction: what the tools did to it in that tick */
  double torque[3]; /**< about the object's origin */
  double silent;    /**< s since the last pose from an application; 0 if there was none */
  uint32_t movable;
  uint32_t contact; /**< 1 while a tool touches it */
  uint32_t driven;  /**< 1 once an application gave it a pose */
  uint32_t reserved;
} spm_client_object;

SPM_CLIENT_API int spm_client_read_tick(const spm_client* client, spm_client_tick* tick);

/** Waits until a tick after `after` is published, at most `timeout` s (0 to 1e6), and tells which
 *  (`tick` may be NULL). For a program that does something in each tick: give it the tick that was
 *  read last. It sleeps until the tick is due, and looks every 0.1 ms if it is late.
 *  SPM_CLIENT_NOT_THERE if none came in time, SPM_CLIENT_NO_DAEMON if the daemon is gone. */
SPM_CLIENT_API int spm_client_wait_tick(const spm_client* client, uint64_t after, double timeout,
                                        spm_client_tick* tick);

/** Reads one device: about 100 ns. */
SPM_CLIENT_API int spm_client_read_device(const spm_client* client, uint32_t device,
                                          spm_client_device* state);

/** Reads one object by its id. */
SPM_CLIENT_API int spm_client_read_object(const spm_client* client, uint64_t object,
                                          spm_client_object* state);

/** Reads where a device's hand touches, with a tool, a ball or a point: the strongest places, up to
 *  `max` and never more than SPM_CLIENT_MAX_CONTACTS. Set `size` in the first element; it holds for
 *  all of them. `*count` is how many were read; `tick` (which may be NULL) is that of all of
 *  them. What the tools do to an object altogether is in spm_client_object. */
SPM_CLIENT_API int spm_client_read_contacts(const spm_client* client, uint32_t device,
                                            spm_client_tick* tick, spm_client_contact* contacts,
                                            size_t max, size_t* count);

/** Reads devices and objects of one and the same tick, up to the given numbers. Set `size` in the
 *  first element of each array; it holds for all of them. `tick` gives how many there are. An array
 *  may be NULL if its number is 0. */
SPM_CLIENT_API int spm_client_read_all(const spm_client* client, spm_client_tick* tick,
                                       spm_client_device* devices, size_t max_devices,
                                       spm_client_object* objects, size_t max_objects);

/* --- Commands --------------------------------------------------------------------------------- */

/** Where an object lies. The application owns the dynamics: it sends poses at its own 60 to 120 Hz,
 *  and the servo moves the object over the time between them. */
typedef struct spm_client_pose {
  uint32_t size;
  uint32_t reserved;
  double position[3];    /**< within 100 m of the origin */
  double orientation[4]; /**< unit within a thousandth */
  double period;         /**< s until the next pose, at most 1; 0: not known */
  double deadline;       /**< s from now, after which the command is refused; 0: none */
} spm_client_pose;

enum spm_client_material_field {
  SPM_CLIENT_STIFFNESS = 1,
  SPM_CLIENT_FRICTION = 2,
  SPM_CLIENT_DAMPING = 4,
  SPM_CLIENT_TEXTURE = 8
};

/** How an object feels, within the daemon's caps. What is not among `fields` stays as it is. */
typedef struct spm_client_material {
  uint32_t size;
  uint32_t fields;           /**< enum spm_client_material_field, added up */
  double stiffness;          /**< N/m, 0 to 1e5 */
  double friction_stick;     /**< mu at rest, from friction_slide to 10 */
  double friction_slide;     /**< mu in motion, 0 or more */
  double damping;            /**< N s/m, 0 to 1000 */
  double texture_amplitude;  /**< m, 0 to 0.1 */
  double texture_wavelength; /**< m, 1e-6 to 1 */
  uint64_t texture_seed;
} spm_client_material;

/** Adds an object of an asset that the daemon serves, at `pose`, scaled by `scale` (above 0). What
 *  `material` (which may be NULL) does not give has the default of a scene. Sets *object to the id
 *  that it will have. */
SPM_CLIENT_API int spm_client_add_object(spm_client* client, uint32_t asset,
                                         const spm_client_pose* pose, double scale,
                                         const spm_client_material* material, uint64_t* object);
SPM_CLIENT_API int spm_client_move_object(spm_client* client, uint64_t object,
                                          const spm_client_pose* pose);
/** Puts an object to a pose at once, as if it were lifted and put down there; `period` has no
 *  meaning. A hand that touched it feels it go, one that is there feels it come. */
SPM_CLIENT_API int spm_client_place_object(spm_client* client, uint64_t object,
                                           const spm_client_pose* pose);
/** Removes an object that this application added, or a supervisor one that any application did. */
SPM_CLIENT_API int spm_client_remove_object(spm_client* client, uint64_t object);
SPM_CLIENT_API int spm_client_set_material(spm_client* client, uint64_t object,
                                           const spm_client_material* material);
/** With `on` 1 the device's hand moves freely while its tool stays in the scene; with 0 the tool
 *  follows again from there. The clutch belongs to the application that took it until it lets go or
 *  leaves; the loop refuses it to others meanwhile. */
SPM_CLIENT_API int spm_client_set_clutch(spm_client* client, uint32_t device, int on);

/** Holds a device's force below `newtons` (0 to 1000) while this application is connected. It never
 *  raises the cap of the daemon, and the lowest of all applications holds: a large number lifts
 * this application's own. The cap goes there by 60 N/s. */
SPM_CLIENT_API int spm_client_set_force_cap(spm_client* client, uint32_t device, double newtons);

/** A push: a force, and a torque, on a device's hand beside what the scene gives, for a while. */
typedef struct spm_client_push {
  uint32_t size;
  uint32_t reserved;
  double force[3];  /**< N, each within 1000, world frame */
  double torque[3]; /**< N m about the tool's origin, each within 100; zero for a device that gives
                         no torque (torque_cap 0), which the loop refuses otherwise */
  double hold;      /**< s, above 0 and at most 1: how long it acts from this call on */
} spm_client_push;

/** Pushes a device's hand, under all that limits the scene's force; all pushes and effects together
 *  are held below the force cap, and their torque below the torque cap, before they are added. It
 * replaces this application's last push on the device; those of several applications are added. An
 * application that sends no next one before `hold` is over stops pushing. */
SPM_CLIENT_API int spm_client_push_hand(spm_client* client, uint32_t device,
                                        const spm_client_push* push);

enum spm_client_effect_kind {
  SPM_CLIENT_SPRING = 1,  /**< pulls towards `point` */
  SPM_CLIENT_VISCOUS = 2, /**< brakes by `damping` */
  SPM_CLIENT_MAGNET = 3,  /**< pulls to the surface of `object` from outside, within its margin */
  SPM_CLIENT_DETENTS = 4  /**< pulls along `axis` to the nearest of planes `spacing` apart, one of
                               them at `point`; two or three that cross make lines or points */
};

/** A simple effect on a hand. What its kind does not use is left at 0. A pull rises with
 *  `stiffness`, stays at `most_force`, and falls as steeply to zero at `range`, or half way between
 *  two detents. */
typedef struct spm_client_effect {
  uint32_t size;
  uint32_t kind;     /**< enum spm_client_effect_kind */
  double stiffness;  /**< N/m, 0 to 1e5 */
  double damping;    /**< N s/m, 0 to 1000 */
  double most_force; /**< N, to 1000; 0: no limit of its own */
  double range;      /**< m, to 100; 0: none. Of detents: how far from `point` the last one is */
  double spacing;    /**< m, 1e-5 to 100 */
  double point[3];   /**< world frame, within 100 m */
  double axis[3];    /**< unit within a thousandth */
  uint64_t object;   /**< id; the object may be anybody's. Where it is removed, so is the magnet. */
} spm_client_effect;

#define SPM_CLIENT_ALL_EFFECTS UINT32_MAX

/** Sets an effect on a device's hand, or changes the one that has this `number` (which the
 *  application chooses, below SPM_CLIENT_ALL_EFFECTS). It fades in over 0.15 s, stays until it is
 *  removed, and fades with its application. Its numbers go over into new ones; its point moves
 *  evenly from one call's to the next, and no faster than changes the force by 60 N/s. A device has
 * room for 16, of all applications. All on a device together are held to a third of the stiffness
 * "auto" for it and to half of the damping that it bears, each in proportion. A pull brakes as much
 * as its sampling would give back. */
SPM_CLIENT_API int spm_client_set_effect(spm_client* client, uint32_t device, uint32_t number,
                                         const spm_client_effect* effect);
/** Removes an effect that this application set, which fades over 0.15 s; with
 * SPM_CLIENT_ALL_EFFECTS all that it set on the device, and for a supervisor all that anybody set.
 */
SPM_CLIENT_API int spm_client_remove_effect(spm_client* client, uint32_t device, uint32_t number);

/** Says that all is well again after a fault, where the daemon waits for it (`--recovery
 *  acknowledge`, SPM_CLIENT_OFF_UNACKNOWLEDGED): the force fades in. It counts in the one tick that
 *  takes it, and only when the fault is over; where nothing waits it does nothing. While another
 *  application holds the device's clutch the loop refuses it, but not to a supervisor. */
SPM_CLIENT_API int spm_client_acknowledge(spm_client* client, uint32_t device);

typedef struct spm_client_command_counts {
  uint32_t size;
  uint32_t last_refusal; /**< why: a number for spm_client_refusal */
  uint64_t sent;         /**< put into the ring */
  uint64_t taken;        /**< read by the loop */
  uint64_t refused;      /**< not followed by the loop */
  uint64_t last_refused; /**< its number, 1 for the first command that was sent */
} spm_client_command_counts;

SPM_CLIENT_API int spm_client_refusals(const spm_client* client, spm_client_command_counts* counts);

/** Why a command was refused and what to do, a sentence; never NULL. */
SPM_CLIENT_API const char* spm_client_refusal(uint32_t refusal);

/* --- Events ----------------------------------------------------------------------------------- */

enum spm_client_event_kind {
  SPM_CLIENT_CONTACT_BEGAN = 1,
  SPM_CLIENT_CONTACT_ENDED = 2,
  SPM_CLIENT_BUTTON_PRESSED = 3,  /**< value: the button's bit number */
  SPM_CLIENT_BUTTON_RELEASED = 4, /**< value: the button's bit number */
  SPM_CLIENT_FORCE_CUT = 5,       /**< value: the cause */
  SPM_CLIENT_FORCE_BACK = 6,
  SPM_CLIENT_DEVICE_LOST = 7,
  SPM_CLIENT_DEVICE_FOUND = 8,
  SPM_CLIENT_DAEMON_LOST = 9,  /**< the daemon ended or was killed; device and tick are 0 */
  SPM_CLIENT_DAEMON_FOUND = 10 /**< one is there again: what the application had set is not */
};

typedef struct spm_client_event {
  uint32_t size;
  uint32_t kind; /**< enum spm_client_event_kind */
  uint32_t device;
  uint32_t value;
  uint64_t tick; /**< the tick in which it was seen */
} spm_client_event;

/** The next change of a device since the last call; SPM_CLIENT_NOT_THERE if there is none. A
 * contact or a cut that began and ended between two calls gives both events; a button that was
 * pressed and released between them gives none. Call it from one thread only. */
SPM_CLIENT_API int spm_client_next_event(spm_client* client, spm_client_event* event);

#ifdef __cplusplus
}
#endif

#include "spm_client_counts.h"
#include "spm_client_live.h"

#endif

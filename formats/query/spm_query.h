/* SPDX-License-Identifier: Apache-2.0 */
/** libspm_query: signed distance, normal and force from a baked asset, for programs with their own
 *  loop. Opening validates the whole file and allocates; after it no call allocates, locks, throws,
 *  starts a thread or keeps global state, and any number of threads may query one asset at once.
 *  Points are in the asset's frame, metres; forces in newtons, acting on the hand. */
#ifndef SPM_QUERY_H
#define SPM_QUERY_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define SPM_QUERY_API __attribute__((visibility("default")))
#else
#define SPM_QUERY_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** 2: SPM_QUERY_METHOD_PAPER_PROBE, and the members of spm_query_force_settings from `probe` on;
 *  `paper` serves balls. A program that was built for version 1 runs as it did: the new members are
 *  read for the new method alone. */
#define SPM_QUERY_VERSION 2

typedef struct spm_query_asset spm_query_asset;

enum spm_query_status {
  SPM_QUERY_EXACT = 0, /**< in the band */
  SPM_QUERY_DEEP = 1,  /**< inside, beyond the band: distance is -max_depth, a bound */
  SPM_QUERY_FAR = 2,   /**< outside, beyond the margin: distance is NaN, normal zero */
  SPM_QUERY_PRUNED = 3 /**< left out by the bake: distance is NaN, normal zero */
};

enum spm_query_source {
  SPM_QUERY_TILE = 0, /**< a distance map, or the one of two that counts */
  SPM_QUERY_TRIANGLES = 1,
  SPM_QUERY_NONE = 2
};

enum spm_query_method {
  SPM_QUERY_METHOD_SPM = 0,
  SPM_QUERY_METHOD_PAPER = 1,      /**< eq. 9 on a point, eq. 10 and 11 on a ball; `full` assets */
  SPM_QUERY_METHOD_PAPER_PROBE = 2 /**< the same, by `probe` and what follows it; since version 2 */
};

/** Kinds of probes. Since version 2. */
enum spm_query_probe { SPM_QUERY_PROBE_BALL = 0, SPM_QUERY_PROBE_CAPSULE = 1 };

/** What the force on a probe is the mean over (section 3.2 of the paper). Since version 2. */
enum spm_query_form { SPM_QUERY_FORM_SURFACE = 0, SPM_QUERY_FORM_VOLUME = 1 };

/** Answer at a point. */
typedef struct spm_query_answer {
  double distance;  /**< signed, m, negative inside */
  double normal[3]; /**< unit, outward */
  int32_t plane;    /**< row of the plane table, -1 for triangles */
  int32_t layer;  /**< of a `full` asset the crossing along the plane's ray, 0 the first; else -1 */
  int32_t source; /**< enum spm_query_source */
  int32_t status; /**< enum spm_query_status */
} spm_query_answer;

/** What a force is computed with. Zero-initialised it is the spm method with no stiffness. */
typedef struct spm_query_force_settings {
  double stiffness;    /**< N/m, 0 or more */
  double probe_radius; /**< m, 0 is a point; at most the asset's */
  int32_t method;      /**< enum spm_query_method */
  /* Since version 2, and read for SPM_QUERY_METHOD_PAPER_PROBE alone. */
  int32_t probe;        /**< enum spm_query_probe */
  double probe_length;  /**< m, of a capsule: between the centres of its ends, above 0 */
  double probe_axis[3]; /**< along a capsule, of any length above 0; all zero is the z axis */
  int32_t form;         /**< enum spm_query_form; volume wants a probe with a radius */
  int32_t reserved;     /**< 0 */
} spm_query_force_settings;

/** Force for a probe. */
typedef struct spm_query_contact {
  double force[3];
  double normal[3];
  double depth;    /**< m, that the force used */
  int32_t contact; /**< 1 in contact */
  int32_t deep;    /**< 1 where depth is the band's bound */
} spm_query_contact;

/** Opens, validates and maps a baked file. Returns 0 and sets *asset, or the exit code of the
 *  command-line contract (1 for a NULL path or asset, 2 file, 3 not an intact asset, 5 a big-endian
 *  or 32-bit machine) and writes one sentence to `message`, cut to `message_size` with its closing
 *  zero; `message` may be NULL.
 *  The file is mapped, not copied: opening installs a handler for SIGBUS, which passes on whatever
 *  does not come from a truncated asset. */
SPM_QUERY_API int spm_query_open(const char* path, spm_query_asset** asset, char* message,
                                 size_t message_size);

/** Closes an asset; NULL is allowed. */
SPM_QUERY_API void spm_query_close(spm_query_asset* asset);

/** 1 once bytes of the file vanished under the map (somebody truncated it): answers are no longer
 * to be trusted and the force to send is zero. Lock-free. */
SPM_QUERY_API int spm_query_lost(const spm_query_asset* asset);

/** Band of an asset, metres: depth inside and margin outside that are answered exactly. */
SPM_QUERY_API void spm_query_band(const spm_query_asset* asset, double* max_depth, double* margin);

/** Bytes that answers may come from: the file, and the small tables that opening adds to it, such
 * as that of the planes. */
SPM_QUERY_API size_t spm_query_memory(const spm_query_asset* asset);

/** Bounding box of the object, metres. */
SPM_QUERY_API void spm_query_box(const spm_query_asset* asset, double box_min[3],
                                 double box_max[3]);

/** Answers at one point. A point that is not finite is `far`. */
SPM_QUERY_API void spm_query_point(const spm_query_asset* asset, const double point[3],
                                   spm_query_answer* answer);

/** Answers at `count` points, x y z each; the same answers as spm_query_point. */
SPM_QUERY_API void spm_query_batch(const spm_query_asset* asset, const double* points, size_t count,
                                   spm_query_answer* answers);

/** Force for a probe at a point. Returns 0, or 1 for settings out of range (then the force is
 * zero): a negative or non-finite stiffness, a probe whose radius is larger than the asset's,
 * `paper` on a sparse asset, a capsule without a length or a radius. Its time is bounded, whatever
 * the probe's size. */
SPM_QUERY_API int spm_query_force(const spm_query_asset* asset,
                                  const spm_query_force_settings* settings, const double point[3],
                                  spm_query_contact* contact);

#ifdef __cplusplus
}
#endif

#endif

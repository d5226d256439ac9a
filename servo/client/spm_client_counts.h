/* SPDX-License-Identifier: Apache-2.0 */
/** What the daemon counts, and who is connected: a part of spm_client.h, which includes it. Include
 *  that one. */
#ifndef SPM_CLIENT_COUNTS_H
#define SPM_CLIENT_COUNTS_H

#ifndef SPM_CLIENT_H
#error "include spm_client.h, which includes this file"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** What the loop counted since it began; SPM_CLIENT_NOT_THERE before that. For a shorter time, such
 *  as the last second, take the difference of two of these. */
typedef struct spm_client_loop {
  uint32_t size;
  uint32_t reserved;
  int64_t time_ns;      /**< when the last tick that is counted began, of CLOCK_MONOTONIC */
  uint64_t ticks;       /**< that were run */
  uint64_t missed;      /**< not finished before the next one was due, including skipped ones */
  uint64_t skipped;     /**< missed ticks that were not run at all */
  uint64_t busy_ns;     /**< working time of all ticks together */
  uint64_t wake_max_ns; /**< the largest lateness of a tick */
  uint64_t busy_max_ns; /**< the longest working time of a tick */
  uint64_t taken;       /**< commands of all applications */
  uint64_t refused;     /**< commands that were not followed */
  uint64_t garbage;     /**< data from applications that was no command */
  uint64_t wake[64];    /**< ticks by how late they began; spm_client_bucket_end */
  uint64_t busy[64];    /**< ticks by how long they worked */
  uint64_t degraded;    /**< ticks that had too little time for all objects */
  uint64_t held;        /**< answers of objects that were coarser by that: the last plane */
  uint64_t shortened;   /**< the same: a proxy that made fewer queries */
  uint64_t coarse;      /**< ticks of devices at a coarser level of the tool's samples */
} spm_client_loop;

SPM_CLIENT_API int spm_client_read_loop(const spm_client* client, spm_client_loop* loop);

/** The end of a bucket of `wake` and `busy`, ns. Durations in it are shorter than its end, and not
 *  shorter than the end of the bucket before. The last bucket also contains everything longer. 0 if
 *  there is no such bucket. */
SPM_CLIENT_API uint64_t spm_client_bucket_end(uint32_t bucket);

/** What the loop counted for one device since it began. */
typedef struct spm_client_device_counts {
  uint32_t size;
  uint32_t last_cause;       /**< the last cause of zero force; 0: none so far */
  uint64_t contact_ticks;    /**< ticks in which it touched */
  uint64_t cap_hits;         /**< ticks in which the force cap limited the force */
  uint64_t slew_hits;        /**< ticks in which the slew limit limited the force */
  double force_max;          /**< N, as sent */
  double energy;             /**< J, net work on the hand of what was sent, pushes among it */
  double generated_max;      /**< J, largest positive value of `energy` */
  uint64_t torque_cap_hits;  /**< ticks in which the torque cap limited the torque */
  uint64_t torque_slew_hits; /**< ticks in which the slew limit limited the torque */
  uint64_t tool_cap_hits;    /**< ticks in which the coupling of hand and tool met its cap */
  double torque_max;         /**< N m, as sent */
} spm_client_device_counts;

SPM_CLIENT_API int spm_client_read_device_counts(const spm_client* client, uint32_t device,
                                                 spm_client_device_counts* counts);

/** An application that is connected; this one is among them. */
typedef struct spm_client_application {
  uint32_t size;
  uint32_t connection; /**< numbered from 1, never used again */
  uint32_t process;
  uint32_t role; /**< enum spm_client_role */
  char name[64]; /**< its own name for itself: spm_client_options.application */
} spm_client_application;

/** Reads one connected application. SPM_CLIENT_NOT_THERE if `index` is not below their number. */
SPM_CLIENT_API int spm_client_read_application(const spm_client* client, uint32_t index,
                                               spm_client_application* application);

#ifdef __cplusplus
}
#endif

#endif

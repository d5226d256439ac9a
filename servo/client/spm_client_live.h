/* SPDX-License-Identifier: Apache-2.0 */
/** What a live view needs beside the rest: leading the hand of a simulated device, how objects feel
 *  now and by which method, and where their assets lie. A part of spm_client.h, which includes it.
 * Include that one. */
#ifndef SPM_CLIENT_LIVE_H
#define SPM_CLIENT_LIVE_H

#ifndef SPM_CLIENT_H
#error "include spm_client.h, which includes this file"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Of spm_client_device.hand. */
enum spm_client_hand_state {
  SPM_CLIENT_HAND_OWN = 0,  /**< it goes its own way: a person's, or a simulated one with a plan */
  SPM_CLIENT_HAND_FREE = 1, /**< `--device sim:hand=live`: an application may lead it */
  SPM_CLIENT_HAND_LED = 2   /**< one does */
};

/** Where the hand of a simulated device is to go. The device follows it as a real one follows a
 *  hand: through its grip, its mass and the force that holds it back. */
typedef struct spm_client_hand {
  uint32_t size;
  uint32_t reserved;
  double position[3];    /**< within 100 m of the origin */
  double orientation[4]; /**< unit within a thousandth; ignored by a device that does not turn */
  double hold; /**< s, above 0 and at most 1: from when the loop takes it. Then the hand is
                    let go, unless the next one came */
} spm_client_hand;

/** Leads the hand of a device, or lets it go (`hand` NULL): then it is slack, and stays where the
 *  force leaves it. The hand belongs to the first that leads it until it lets go, sends no next one
 *  in time, or leaves; the loop refuses it to all others meanwhile. */
SPM_CLIENT_API int spm_client_lead_hand(spm_client* client, uint32_t device,
                                        const spm_client_hand* hand);

/** How the force of an object is found: enum spm_client_method. */
enum spm_client_method {
  SPM_CLIENT_METHOD_SPM = 0,
  SPM_CLIENT_METHOD_PAPER = 1,
  SPM_CLIENT_METHOD_PROXY = 2
};

/** Chooses the method (enum spm_client_method) by which an object is felt; the force fades in
 * again. The object becomes this application's as by spm_client_set_material. The loop refuses what
 * the object's asset, probe or effects do not have: `paper` needs a `full` asset. */
SPM_CLIENT_API int spm_client_set_method(spm_client* client, uint64_t object, uint32_t method);

/** Switches the stabilization of the whole scene off (`on` 0) or on: the scene's own, or what is
 *  recommended where it has none. The loop refuses it to all but a supervisor, and the force fades
 *  in again. Without it a device may shake: for trying what it does. */
SPM_CLIENT_API int spm_client_stabilize(spm_client* client, int on);

/** How an object feels now, before the limits of the device. */
typedef struct spm_client_feel {
  uint32_t size;
  uint32_t method;     /**< enum spm_client_method */
  uint32_t stabilized; /**< 1: the scene's stabilization is on */
  uint32_t reserved;
  double stiffness; /**< N/m */
  double friction_stick;
  double friction_slide;
  double damping;            /**< N s/m */
  double texture_amplitude;  /**< m */
  double texture_wavelength; /**< m */
  uint64_t texture_seed;
} spm_client_feel;

SPM_CLIENT_API int spm_client_read_feel(const spm_client* client, uint64_t object,
                                        spm_client_feel* feel);

/** The absolute path of an asset's file as the daemon opened it, cut to `size` with the closing
 *  zero; "" where it is longer than 511 bytes. */
SPM_CLIENT_API int spm_client_asset_path(const spm_client* client, uint32_t asset, char* path,
                                         size_t size);

/** The stiffness of a shape at which the device begins to shake on it, N/m of the scene, by the
 *  simulations of the stability laboratory; 0 where it is not known. `bare` is that of a flat wall
 *  without stabilization, `stabilized` that of the worst case with the default settings. Either
 *  may be NULL. */
SPM_CLIENT_API int spm_client_border(const spm_client* client, uint32_t device, double* bare,
                                     double* stabilized);

#ifdef __cplusplus
}
#endif

#endif

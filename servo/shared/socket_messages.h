/* SPDX-License-Identifier: Apache-2.0 */
/** The messages over the daemon's Unix socket (SOCK_SEQPACKET): a greeting from the daemon with the
 *  two descriptors, the client's message that it has mapped them, and the daemon's confirmation.
 *  After that the socket only shows each side that the other is still there. Internal to both. */
#ifndef SPM_SOCKET_MESSAGES_H
#define SPM_SOCKET_MESSAGES_H

#include "shared_layout.h"

#define SPM_SOCKET_VERSION 2u
#define SPM_SOCKET_MAGIC UINT64_C(0x6b636f53204d5053) /* the bytes SPM Sock */

enum { SPM_SENTENCE_BYTES = 256 };

/* spm_socket_answer.status. */
enum { SPM_SOCKET_WELCOME = 0, SPM_SOCKET_REFUSED = 1, SPM_SOCKET_OTHER_VERSION = 2 };

/** From the daemon: at once after the connection, with the descriptors of state and ring if the
 *  client is welcome; and once more, without descriptors, after the client's spm_socket_ready. */
typedef struct spm_socket_answer {
  uint64_t magic;
  uint32_t socket_version; /* these four fields are at the same place in all versions */
  uint32_t layout_version;
  uint32_t status;
  uint32_t connection; /* numbered from 1; upper half of the ids of objects that the client adds */
  uint32_t state_bytes;
  uint32_t ring_bytes;
  char daemon_version[SPM_VERSION_BYTES];
  char sentence[SPM_SENTENCE_BYTES]; /* why not; closed by a zero */
} spm_socket_answer;

/* spm_socket_ready.role. */
enum { SPM_ROLE_APPLICATION = 0, SPM_ROLE_SUPERVISOR = 1, SPM_ROLE_OBSERVER = 2 };

/** From the client, when it has mapped both regions: from now on the daemon lets nobody map or
 *  shrink its ring. */
typedef struct spm_socket_ready {
  uint64_t magic;
  uint32_t socket_version;
  uint32_t layout_version;
  char library_version[SPM_VERSION_BYTES];
  char application[SPM_NAME_BYTES];
  uint32_t role; /* a supervisor may change what is another application's, an observer nothing */
  uint32_t reserved;
} spm_socket_ready;

SPM_LAYOUT_ASSERT(sizeof(spm_socket_answer) == 32 + 32 + 256, "layout");
SPM_LAYOUT_ASSERT(sizeof(spm_socket_ready) == 16 + 32 + 64 + 8, "layout");

#endif

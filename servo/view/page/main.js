// SPDX-License-Identifier: Apache-2.0
// The page of spm-servo view: live, or of recordings.

import { startLive } from './live.js';
import { startPlayer } from './player.js';

if (document.body.dataset.mode === 'recording') await startPlayer();
else startLive();

// SPDX-License-Identifier: Apache-2.0
// The connection to spm-servo view, which comes back by itself.

const FIRST_WAIT = 300; // ms; doubled at each failure
const LONGEST_WAIT = 3000;

export class Link {
  /** `on` has open(), closed(), frame(Float64Array) and message(object). */
  constructor(on) {
    this.on = on;
    this.wait = FIRST_WAIT;
    this.connect();
  }

  connect() {
    const address = new URL('ws', location.href);
    address.protocol = 'ws:';
    const socket = new WebSocket(address);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.socket = socket;
      this.wait = FIRST_WAIT;
      this.on.open();
    };
    socket.onmessage = ({ data }) => {
      if (typeof data === 'string') this.on.message(JSON.parse(data));
      else {
        this.on.frame(new Float64Array(data));
        this.send({ t: 'seen' }); // the view waits for it, so that frames never pile up on the way
      }
    };
    socket.onclose = () => {
      this.socket = null;
      this.on.closed();
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    };
  }

  /** Sends a message; false where there is no connection. */
  send(message) {
    if (!this.socket || this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}

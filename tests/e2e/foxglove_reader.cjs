// SPDX-License-Identifier: Apache-2.0
// Reads what spm-servo writes and serves for Foxglove viewers, by the viewers' own packages, and prints
// what it found as JSON. Every message is checked against Foxglove's schema of its name, where there is
// one, and against the schema that came with it.
//
// Usage: node foxglove_reader.cjs PACKAGES mcap FILE
//        node foxglove_reader.cjs PACKAGES live ADDRESS MESSAGES [ORIGIN]

const { createRequire } = require('node:module');
const { open } = require('node:fs/promises');
const path = require('node:path');

const [packages, mode, target, ...more] = process.argv.slice(2);
const load = createRequire(path.join(path.resolve(packages), 'package.json'));
const Ajv = load('ajv');
const official = load('@foxglove/schemas/jsonschema');

const ajv = new Ajv({ strict: false });
const checks = new Map();
function check(name, text, message) {
  if (!checks.has(name)) {
    const known = official[name.replace('foxglove.', '')];
    checks.set(name, [JSON.parse(text), ...(known ? [known] : [])].map((schema) => ajv.compile(schema)));
  }
  for (const valid of checks.get(name)) {
    if (!valid(message)) throw new Error(`${name}: ${ajv.errorsText(valid.errors)}`);
  }
  return checks.get(name).length > 1;
}

/** What is told of the messages of a topic. */
function note(found, topic, name, message, time, isOfficial) {
  const one = found[topic] ??= { schema: name, official: isOfficial, count: 0, first: null, firstTime: time };
  one.count += 1;
  one.first ??= message;
  one.last = message;
  one.lastTime = time;
}

async function readMcap() {
  const { McapIndexedReader } = load('@mcap/core');
  const handle = await open(target);
  const { size } = await handle.stat();
  const reader = await McapIndexedReader.Initialize({ readable: {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await handle.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  } });
  const topics = {};
  for await (const { channelId, data, logTime } of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    const message = JSON.parse(new TextDecoder().decode(data));
    const isOfficial = check(schema.name, new TextDecoder().decode(schema.data), message);
    note(topics, channel.topic, schema.name, message, Number(logTime), isOfficial);
  }
  await handle.close();
  return { topics, chunks: reader.chunkIndexes.length, messages: Number(reader.statistics.messageCount),
    library: reader.header.library };
}

/** Subscribes to all channels, until each hand's tick has come so many times. */
function listen() {
  const { FoxgloveClient } = load('@foxglove/ws-protocol');
  const { WebSocket } = load('ws');
  const [wanted, origin] = more;
  const topics = {}, channels = new Map(), found = { topics, statuses: [] };
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(target, [FoxgloveClient.SUPPORTED_SUBPROTOCOL], origin ? { origin } : {});
    socket.on('unexpected-response', (_, response) => {
      let text = '';
      response.on('data', (part) => { text += part; });
      response.on('end', () => resolve({ refused: response.statusCode, text }));
    });
    const client = new FoxgloveClient({ ws: socket });
    client.on('error', reject);
    client.on('serverInfo', (info) => { found.server = info; });
    client.on('status', (status) => found.statuses.push(status));
    client.on('advertise', (list) => list.forEach((channel) => {
      channels.set(client.subscribe(channel.id), channel);
    }));
    client.on('message', ({ subscriptionId, timestamp, data }) => {
      const channel = channels.get(subscriptionId);
      const message = JSON.parse(new TextDecoder().decode(data));
      note(topics, channel.topic, channel.schemaName, message, Number(timestamp),
        check(channel.schemaName, channel.schema, message));
      const ticks = Object.entries(topics).filter(([topic]) => topic.endsWith('/tick'));
      if (!ticks.some(([, { count }]) => count >= Number(wanted)) || found.ended) return;
      found.ended = true;
      found.protocol = socket.protocol;
      client.close();
      resolve(found);
    });
  });
}

(mode === 'mcap' ? readMcap() : listen()).then(
  (found) => { process.stdout.write(JSON.stringify(found)); },
  (problem) => { process.stderr.write(`${problem.stack}\n`); process.exit(1); });

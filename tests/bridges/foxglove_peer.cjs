// A client of Foxglove's protocol that does what lines of JSON on stdin say, and writes what
// comes as lines of JSON.
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const WebSocket = require("ws");
const readline = require("readline");

const protocols = [FoxgloveClient.SUPPORTED_SUBPROTOCOL, "foxglove.sdk.v1"];
const socket = new WebSocket(process.argv[2], protocols);
const client = new FoxgloveClient({ ws: socket });
const channels = new Map();
const subscriptions = new Map();
const own = new Map();
const services = new Map();

function plain(key, value) {
  if (typeof value === "bigint") return Number(value);
  if (ArrayBuffer.isView(value)) {
    const numbers = Array.from(value, Number);
    return numbers.length > 64 ? { length: numbers.length, sum: numbers.reduce((a, b) => a + b, 0) } : numbers;
  }
  return value;
}
const tell = (event, body) => process.stdout.write(JSON.stringify({ event, ...body }, plain) + "\n");
const bytes = (text) => Buffer.from(text, "base64");

client.on("open", () => tell("open", { protocol: socket.protocol }));
client.on("close", () => { tell("close", {}); process.exit(0); });
client.on("error", (error) => tell("error", { message: String(error && error.message) }));
client.on("serverInfo", (info) => tell("serverInfo", { info }));
client.on("status", (status) => tell("status", { status }));
client.on("advertise", (list) => {
  for (const channel of list) channels.set(channel.topic, channel);
  tell("advertise", { channels: list.map(({ id, topic, encoding, schemaName, schemaEncoding }) => ({ id, topic, encoding, schemaName, schemaEncoding })) });
});
client.on("unadvertise", (ids) => tell("unadvertise", { ids }));
client.on("advertiseServices", (list) => {
  for (const service of list) services.set(service.name, service);
  tell("services", { services: list.map(({ name, type }) => ({ name, type })) });
});
client.on("unadvertiseServices", (ids) => tell("servicesGone", { ids }));
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const one = subscriptions.get(subscriptionId);
  if (!one) return; // It was on its way when we unsubscribed.
  const { topic, reader } = one;
  tell("message", { topic, time: timestamp, at: Date.now(), size: data.byteLength, message: reader.readMessage(data) });
});
client.on("time", ({ timestamp }) => tell("time", { time: timestamp }));
client.on("parameterValues", ({ parameters, id }) => tell("parameters", { parameters, id }));
client.on("connectionGraphUpdate", (graph) => tell("graph", { graph }));
client.on("serviceCallResponse", ({ callId, data }) =>
  tell("answer", { callId, data: Buffer.from(data.buffer, data.byteOffset, data.byteLength).toString("base64") }));
client.on("serviceCallFailure", (failure) => tell("failure", { failure }));
client.on("fetchAssetResponse", ({ requestId, status, data, error }) =>
  tell("asset", { requestId, status, error, data: data ? Buffer.from(data.buffer, data.byteOffset, data.byteLength).toString("base64") : null }));

const operations = {
  subscribe({ topic }) {
    const channel = channels.get(topic);
    const reader = new MessageReader(parse(channel.schema, { ros2: true }));
    subscriptions.set(client.subscribe(channel.id), { topic, reader });
  },
  unsubscribe({ topic }) {
    for (const [id, one] of subscriptions) if (one.topic === topic) { client.unsubscribe(id); subscriptions.delete(id); }
  },
  publish({ topic, type, encoding, data }) {
    if (!own.has(topic)) own.set(topic, client.advertise({ topic, encoding, schemaName: type }));
    client.sendMessage(own.get(topic), new Uint8Array(bytes(data)));
  },
  call({ service, encoding, data }) {
    const view = bytes(data);
    client.sendServiceCallRequest({ serviceId: services.get(service).id, callId: 7, encoding, data: new DataView(view.buffer, view.byteOffset, view.byteLength) });
  },
  get({ names, id }) { client.getParameters(names, id); },
  set({ parameters, id }) { client.setParameters(parameters, id); },
  watch({ names }) { client.subscribeParameterUpdates(names); },
  graph() { client.subscribeConnectionGraph(); },
  asset({ uri, id }) { client.fetchAsset(uri, id); },
  raw({ data }) { socket.send(bytes(data)); },
  freeze() { socket._socket.pause(); tell("frozen", {}); },
};
readline.createInterface({ input: process.stdin }).on("line", (line) => {
  const { op, ...body } = JSON.parse(line);
  try { operations[op](body); } catch (error) { tell("fault", { message: String(error.stack) }); }
}).on("close", () => process.exit(0));

// The page around the view: a model that talks to Python over a WebSocket, as a notebook's model does.
const query = new URL(import.meta.url).search;
const AGAIN_MS = 2000;  // between two tries to reach the server
const {default: studio} = await import("./studio.js" + query);

class SocketModel {
  #values = {online: true};
  #changed = new Set();
  #listeners = new Map();
  #socket = null;
  #session = "";
  #message = null;  // a message whose buffers are still to come
  #buffers = [];
  #restore = false;

  get(name) {
    return this.#values[name];
  }

  set(name, value) {
    if (this.#values[name] === value) return;
    this.#values[name] = value;
    this.#changed.add(name);
    this.#emit("change:" + name);
  }

  on(event, listener) {
    this.#listeners.set(event, [...(this.#listeners.get(event) ?? []), listener]);
  }

  off(event, listener) {
    this.#listeners.set(event, (this.#listeners.get(event) ?? []).filter((known) => known !== listener));
  }

  save_changes() {
    if (this.#changed.has("state")) this.#write({set: {state: this.#values.state}});
    this.#changed.clear();
  }

  send(content, callbacks, buffers = []) {
    if (buffers.length) this.#post(content, buffers[0]);
    else this.#write({message: content});
  }

  connect() {
    const address = new URL("socket" + query, location.href);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = this.#socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.addEventListener("message", (event) => this.#read(event.data));
    socket.addEventListener("close", () => {
      this.#message = null;
      this.#restore = this.#values.state !== undefined;
      this.set("online", false);
      setTimeout(() => this.connect(), AGAIN_MS);
    });
  }

  #write(what) {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(what));
  }

  // Messages with a buffer go by HTTP; the answer comes over the socket.
  async #post(content, buffer) {
    const address = new URL("drop" + query, location.href);
    address.searchParams.set("name", content.name);
    address.searchParams.set("ask", content.ask);
    address.searchParams.set("session", this.#session);
    let fault = "the server cannot be reached";
    try {
      const response = await fetch(address, {method: "POST", body: buffer});
      if (response.ok) return;
      fault = (await response.text()).slice(0, 300) || "status " + response.status;
    } catch { /* said below */ }
    this.#emit("msg:custom", {kind: "error", ask: content.ask, text: content.name + ": " + fault}, []);
  }

  #read(data) {
    if (typeof data !== "string") {
      this.#buffers.push(data);
      if (this.#message && this.#buffers.length >= this.#message.count) this.#deliver();
      return;
    }
    const {session, set, message, buffers = 0} = JSON.parse(data);
    if (session !== undefined) this.#session = session;
    if (set) this.#take(set);
    if (message) {
      this.#message = {content: message, count: buffers};
      this.#buffers = [];
      if (!buffers) this.#deliver();
    }
  }

  #deliver() {
    const {content} = this.#message, buffers = this.#buffers;
    this.#message = null;
    this.#buffers = [];
    this.#emit("msg:custom", content, buffers);
  }

  // After a reconnection the page keeps its state, if the server shows the same scene.
  #take({scene, state}) {
    const own = this.#restore && scene?.name === this.#values.scene?.name;
    this.#restore = false;
    this.#values.scene = scene ?? this.#values.scene;
    if (state && !own) this.#values.state = state;
    if (scene) this.#emit("change:scene");
    if (state && !own) this.#emit("change:state");
    this.#changed.clear();
    this.set("online", true);
    if (own) this.#write({set: {state: this.#values.state}});
  }

  #emit(event, ...values) {
    for (const listener of this.#listeners.get(event) ?? []) listener(...values);
  }
}

const model = new SocketModel();
studio.render({model, el: document.getElementById("studio")});
model.connect();

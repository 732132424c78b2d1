// link.js - the socket: views go out, the newest wins; pictures come in, none older than the last shown.

export class Link extends EventTarget {
  // events: "volume", "picture" {head, bitmap}, "picked", "refused", "open", "closed", "treelets"
  constructor(token) {
    super();
    this.token = token;
    this.number = 0;   // of the last view sent
    this.shown = 0;    // of the last picture shown
    this.part = -1;
    this.shownNumbers = []; // of the last pictures shown, for whoever wants to check
    this.pending = null;
    this.sentAt = new Map();
    this.wait = 250;
    this.decoding = Promise.resolve();
    this.picks = new Map();
    this.slices = new Map(); // what is to be asked for, of each pane
    this.sliceNumber = 0;
    this.sliceAsked = [];   // the number that was sent last for each pane
    this.sliceShown = [];   // the number of each pane's last picture
    this.connect();
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(`${scheme}//${location.host}/socket?token=${encodeURIComponent(this.token)}`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    let opened = false;
    socket.onopen = () => { opened = true; this.wait = 250; this.tell("open"); };
    socket.onmessage = event => typeof event.data === "string" ? this.text(event.data) : this.picture(event.data);
    socket.onclose = async event => {
      for (const done of this.picks.values()) done(null);
      this.picks.clear();
      // there: it serves its page, but no picture: another token, or no place.
      const there = !opened && await fetch("/", {cache: "no-store"}).then(answer => answer.ok, () => false);
      this.tell("closed", {code: event.code, there});
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(5000, 2 * this.wait);
    };
  }

  tell(type, detail) { this.dispatchEvent(new CustomEvent(type, {detail})); }

  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  // One view an animation frame: the newest.
  view(state, width, height, moving, where) {
    if (!this.pending) requestAnimationFrame(() => this.flush());
    this.pending = {state, width, height, moving, where};
    return this.number + 1;
  }

  // A view that view() was told of has gone out: the page of a hidden tab has no frames.
  sent(number) { return number <= this.number; }

  flush() {
    if (!this.pending) return;
    const view = this.pending;
    this.pending = null;
    if (!this.send({type: "view", number: this.number + 1, ...view})) return;
    this.number++;
    this.sentAt.set(this.number, performance.now());
    for (const n of this.sentAt.keys()) if (n < this.shown) this.sentAt.delete(n);
  }

  // A slice for a pane; one a pane and animation frame: the newest.
  slice(pane, what) {
    if (!this.slices.size) requestAnimationFrame(() => {
      for (const [k, newest] of this.slices) {
        if (!this.send({type: "slice", slice: this.sliceNumber + 1, pane: k, ...newest})) continue;
        this.sliceAsked[k] = ++this.sliceNumber;
      }
      this.slices.clear();
    });
    this.slices.set(pane, what);
  }

  open(file) { return this.send({type: "open", file}); }

  // What is at a place of the newest view, a pixel {x, y} or a {point}; null: nobody answered.
  pick(place) {
    this.flush();
    const id = this.pickId = (this.pickId ?? 0) + 1;
    return new Promise(done => {
      this.picks.set(id, done);
      if (!this.send({type: "pick", number: this.number, id, ...place})) { this.picks.delete(id); done(null); }
    });
  }

  text(data) {
    const message = JSON.parse(data);
    if (message.type === "picked") {
      this.picks.get(message.id)?.(message);
      this.picks.delete(message.id);
    } else if (message.type === "refused" && message.id != null && this.picks.has(message.id)) {
      this.picks.get(message.id)(null);
      this.picks.delete(message.id);
    } else this.tell(message.type, message);
  }

  picture(data) {
    const size = new DataView(data).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
    const blob = new Blob([new Uint8Array(data, 4 + size)], {type: `image/${head.format}`});
    const bitmap = createImageBitmap(blob, {colorSpaceConversion: "none"});
    bitmap.catch(() => {});
    // They are decoded at the same time, and shown in their order.
    this.decoding = this.decoding.then(() => bitmap).then(b => this.show(head, b), () => this.seen(head));
  }

  showSlice(head, bitmap) {
    if (head.slice < (this.sliceShown[head.pane] ?? 0)) bitmap.close();
    else {
      this.sliceShown[head.pane] = head.slice;
      this.tell("slice", {head, bitmap});
    }
    this.send({type: "slice-seen", slice: head.slice, pane: head.pane});
  }

  show(head, bitmap) {
    if (head.type === "slice") return this.showSlice(head, bitmap);
    const stale = head.number < this.shown || (head.number === this.shown && head.part <= this.part);
    if (stale) bitmap.close();
    else {
      this.shown = head.number;
      this.part = head.part;
      this.shownNumbers.push(head.number);
      if (this.shownNumbers.length > 10000) this.shownNumbers.shift();
      const sent = this.sentAt.get(head.number);
      this.tell("picture", {head, bitmap, latency: sent == null ? null : performance.now() - sent});
    }
    this.seen(head);
  }

  seen(head) {
    if (head.type === "slice") this.send({type: "slice-seen", slice: head.slice, pane: head.pane});
    else this.send({type: "seen", number: head.number, part: head.part});
  }
}

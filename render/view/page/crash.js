// crash.js - when the process that draws has crashed: which state the page goes on with, and what it says.

const GOOD_MAX = 8; // states kept

export class Crash {
  constructor(app) {
    this.app = app;
    this.talk = null;  // who this page is to the server
    this.life = 0;     // of the server: how often it crashed
    this.asked = null; // the newest view
    this.good = [];    // states whose last picture is shown, the newest last
    this.after = null; // a crash that the page has not yet gone on after
    this.spared = "";  // what was asked for, and not drawn, at a crash that seemed to be another's
  }

  // A view goes out.
  ask(number, flags) { this.asked = {number, which: this.app.volume.which, text: JSON.stringify(flags)}; }

  // A picture is shown.
  shown({number, final}) {
    if (!final || number !== this.asked?.number || this.drawn(this.asked)) return;
    this.good = [...this.good.filter(g => g.text !== this.asked.text || g.which !== this.asked.which), this.asked].slice(-GOOD_MAX);
  }

  drawn(view) { return this.good.at(-1) === view; }

  // Of a connection, what the server says first.
  connected({talk, crash}) {
    if (crash && this.talk !== null && crash.life !== this.life) {
      const text = this.asked?.text, waits = !this.drawn(this.asked) && this.app.link.sent(this.asked?.number);
      const mine = crash.talk === this.talk || waits && (crash.what === "nothing" || text === this.spared);
      this.spared = mine || !waits ? "" : text;
      this.after = {...crash, mine};
    }
    this.life = crash?.life ?? 0;
    this.talk = talk;
  }

  // Draw again; not what has crashed.
  goOn() {
    const {app} = this, {signal, name, what, mine} = this.after, why = `(signal ${signal}, ${name})`;
    this.after = null;
    if (!mine || what === "pick") {
      app.changed(false);
      return app.say(mine ? `Asking what is there crashed ${why}; the view is back.`
        : `The program crashed ${why}, and was started again.`);
    }
    app.movie.stop();
    app.data.stop();
    if (what === "slice") {
      app.slices.hide();
      app.changed(false);
      return app.say(`Drawing a slice crashed ${why}; the view is back, without slices.`);
    }
    this.goBack(why);
  }

  goBack(why) {
    const {app, asked} = this, {which, state} = app.volume;
    this.good = this.good.filter(g => g.which === which && g.text !== asked?.text);
    const good = this.good.at(-1);
    if (good) app.adopt(JSON.parse(good.text));
    else if (asked.text !== this.first) this.begin(state);
    else {
      app.honesty.mark("not drawn", "bad");
      return app.say(`Drawing this picture crashed ${why}; change something to have it drawn again.`);
    }
    app.say(`Drawing this picture crashed ${why}; ${good ? "the last good view" : "the first view"} is back.`);
  }

  // The server's own state; this.first: as the page asks for it.
  begin(state) {
    this.app.adopt(state, true);
    this.first = this.asked.text;
  }
}

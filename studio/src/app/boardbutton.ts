/** The button of the board: connect, play, turn off. */

import { bring } from "./arraypicker.ts";
import type { Context } from "./context.ts";
import { element, write } from "./dom.ts";
import { attended, type Connection, type ConnectionState, guard } from "../boards/connection.ts";
import { type SerialBoard, type SerialPortLike, boardOf, connect } from "../boards/serial.ts";
import { fits, Served } from "../boards/served.ts";
import { shownOf } from "../solving/studio.ts";
import { type Notice, noticeOf } from "../state/notice.ts";

/** The part of `navigator` that browsers with WebSerial have. */
type WithSerial = Navigator & { serial?: { requestPort(): Promise<SerialPortLike> } };

/** Makes the button: it requests a port, plays the drive of slot A, and turns the board off. */
export function createBoardButton(context: Context): HTMLElement {
  const { studio, engine, say, board: served } = context;
  const away = served ? say("playOn", { name: served.name }) : say("connect");
  const button = element("button", { className: "board" }, away);
  let connection: Connection | null = null;
  let unguard = () => undefined as void;
  /** The drive that the board plays, or will play next. */
  let newest: Float32Array | null = null;

  /** Returns a function that connects the served board, or a board at a port that the user chooses. */
  async function reach(): Promise<(() => Promise<Connection>) | void> {
    if (served) return async () => new Served(served.name, report);
    const { serial } = navigator as WithSerial;
    const { array } = studio.view.state;
    const board = "preset" in array ? boardOf(engine.catalogue, array.preset) : null;
    if (!board) return offer();
    if (!serial) return context.alarm(say("noSerial"));
    const address = location.href;
    const port = await serial.requestPort();
    // Meanwhile another page may have led this page to another address.
    if (location.href === address) return () => open(port, board);
  }

  /** Offers the boards at serial ports, each of which brings its array, and says how all others are played. */
  function offer() {
    const { boards, presets } = engine.catalogue;
    const cards = boards.flatMap(({ name, summary, baud }) => {
      const preset = presets.find(({ board }) => board === name)?.name;
      if (!baud || !preset) return [];
      const take = () => (dialog.close(), void bring(context, { preset, tiles: [1, 1] }).then(() => button.click()));
      return [element("li", {}, element("button", { onclick: take }, element("b", {}, preset), element("span", {}, `${summary}. ${say("plugIn")}`)))];
    });
    const command = element("button", { onclick: () => void context.copy(command, "midair studio --on autd3") }, "midair studio --on autd3");
    const others = element("li", { className: "others" }, element("b", {}, "AUTD3, OpenMPD…"), element("span", {}, say("noBoard")), command);
    const dialog = context.dialog("gallery", say("connect"), element("ul", {}, ...cards, others));
  }

  async function begin() {
    const opening = await reach();
    if (!opening) return;
    const reached = await attended(opening(), window, document);
    connection = reached.connection;
    if (connection.state === "gone") return forget();
    unguard = guard(connection, window, document);
    // If the user left the page meanwhile, the board stays off until the button is pressed again.
    if (reached.present) play();
    else show();
  }

  async function open(port: SerialPortLike, board: SerialBoard): Promise<Connection> {
    await studio.settled();
    const silence = await engine.slots[0].silence(studio.scene(0), board.name);
    const encode = (drive: Float32Array) => engine.slots[0].encode(studio.scene(0), drive, board.name);
    return connect(port, board, encode, silence, report);
  }

  function report(state: ConnectionState, line?: Notice) {
    if (line) context.alarm(say("failed", { line }));
    if (state === "gone") forget();
    show();
  }

  function forget() {
    unguard();
    connection = null;
    show();
  }

  function show() {
    const plays = connection?.state === "playing";
    write(button, plays ? say("playing") : connection ? say("playAgain") : away);
    button.classList.toggle("on", plays);
    context.announce(say(plays ? "boardOn" : "boardOff"));
  }

  function play() {
    const drive = shownOf(studio.view)[0].answer?.drive;
    if (!connection || !drive) return;
    if (served && !fits(served, studio.view.state.array)) {
      context.alarm(say("otherArray", { name: served.name }));
      return void connection.off();
    }
    newest = drive;
    connection.play(drive);
  }

  button.onclick = () => {
    if (connection?.state === "playing") void connection.off();
    else if (connection) play();
    else {
      void begin().catch((error: Error) => {
        if (error.name !== "NotFoundError") context.alarm(say("failed", { line: noticeOf(error) }));
      });
    }
  };
  context.ending(() => void connection?.close());
  context.listen(() => {
    const drive = shownOf(studio.view)[0].answer?.drive;
    if (connection?.state === "playing" && (drive !== newest || (served && !fits(served, studio.view.state.array)))) play();
  });
  return button;
}

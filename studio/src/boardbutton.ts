/** The one button behind which a board plays: connect, play, off. */

import type { Context } from "./context.ts";
import { element, write } from "./dom.ts";
import { type Player, connect, guard, kindOf } from "./serial.ts";

/** Makes the button: it asks for a port, plays what slot A finds, and turns the board off. */
export function createBoardButton(context: Context): HTMLElement {
  const { studio, engine, say } = context;
  const button = element("button", { type: "button", className: "board" }, say("connect"));
  let player: Player | null = null;

  async function begin() {
    const { serial } = navigator as unknown as { serial?: { requestPort(): Promise<never> } };
    if (!serial) return context.alarm(say("noSerial"));
    const board = kindOf(studio.view.state.array, engine.catalogue);
    if (typeof board === "string") return context.alarm(board);
    const port = await serial.requestPort();
    await studio.settled();
    const silence = await engine.quick.silence(0, board.name);
    player = await connect(port, board, () => engine.quick.encode(0, board.name), silence, ended);
    guard(player, window, document);
    write(button, say("playing"));
    button.classList.add("on");
    context.announce(say("boardOn"));
    play();
  }

  function ended(line: string) {
    player = null;
    write(button, say("connect"));
    button.classList.remove("on");
    if (line) context.alarm(line);
    else context.announce(say("boardOff"));
  }

  function play() {
    const { answer } = studio.view.results[0];
    if (player && answer) player.play(answer.drive);
  }

  button.onclick = () => {
    if (player) void player.close();
    else void begin().catch((error: Error) => error.name === "NotFoundError" || context.alarm(error.message));
  };
  studio.listen(play);
  return button;
}

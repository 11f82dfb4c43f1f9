// Solves two foci over a SonicSurface that turn about its axis; then encodes the bytes of the last frame.
import { load } from "midair";

const midair = await load();
const at = (turn) => [0, Math.PI].map((side) => [0.02 * Math.cos(turn + side), 0.02 * Math.sin(turn + side), 0.12]);
const scene = midair.open({
  array: { preset: "sonicsurface" },
  points: at(0).map((position) => ({ position, pressure: 1500 })),
  solver: { name: "glide" },
});
for (let frame = 0; frame < 5; frame++) {
  scene.move(at(0.02 * frame));
  const { status, pressures, metrics } = scene.solve();
  const pascals = pressures.map(([re, im]) => Math.hypot(re, im).toFixed(0));
  console.log(`frame ${frame}: ${status}, ${pascals.join(" and ")} Pa, uniformity ${metrics.uniformity.toFixed(3)}`);
}
console.log(`${scene.encode("sonicsurface").length} bytes for the board`);
scene.free();

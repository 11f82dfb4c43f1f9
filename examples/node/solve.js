// Solves two foci above a SonicSurface and encodes the frame for the board: node build.js && node solve.js
'use strict';

const { Session, frame } = require('.');

const session = new Session('sonicsurface', 'uniform', { temperature: 23 });
const answer = session.solve([[-0.02, 0, 0.15], [0.02, 0, 0.15]], [1000, 1000]);
const { level, uniformity, scale } = answer;
const transducers = answer.drive.length / 2;
const shown = [level, uniformity, scale].map((number) => number.toFixed(3));
console.log(`${transducers} transducers: level ${shown[0]}, uniformity ${shown[1]}, scale ${shown[2]}`);
const bytes = frame('sonicsurface', answer.drive);
console.log(`a frame of ${bytes.length} bytes: ${bytes.slice(0, 3).join(' ')} ...`);

try {
  session.solve([[0, 0, NaN]]);
} catch (error) {
  console.log(`refused: ${error.message}`);
}

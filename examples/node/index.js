// midair for Node: `new Session(preset, method, options)`, `session.solve(points, pressures)`,
// `session.solveBatch(problems, pressures)`, `solveScenes(texts, transducers)`, `frame(board, drive)`.
'use strict';

const binding = require('./midair.node');

function warn(text) {
  if (text !== '') process.emitWarning(text, 'MidairWarning');
}

function warned(answer) {
  warn(answer.warning);
  return answer;
}

// Returns the numbers of nested arrays; undefined stays undefined.
function flat(numbers) {
  return numbers === undefined ? undefined : Float64Array.from(numbers.flat(Infinity));
}

class Session {
  constructor(preset, method = 'uniform', options = {}) {
    warn(binding.open(this, preset, method));
    for (const [name, value] of Object.entries(options)) {
      warn(binding.set(this, name, value));
    }
  }

  // points: [[x, y, z], ...] in m; pressures: [Pa, ...], or undefined for the most that the array reaches. Returns an answer.
  solve(points, pressures) {
    return warned(binding.solve(this, flat(points), flat(pressures)));
  }

  // problems: [[[x, y, z], ...], ...], all with the same number of points; pressures: a row for each problem. Returns an answer
  // for each problem, computed on at most this many threads; 0 means one per processor.
  solveBatch(problems, pressures, threads = 0) {
    return warned(binding.solveBatch(this, flat(problems), problems[0]?.length, flat(pressures), threads));
  }
}

// scenes: the texts of scene files, whose arrays have this many transducers. Returns an answer for each scene.
function solveScenes(scenes, transducers, folder, threads = 0) {
  return warned(binding.solveScenes(scenes, transducers, folder, threads));
}

module.exports = { Session, solveScenes, frame: binding.frame };

// midair for Node: `new Session(preset, method, options)`, `session.solve(points, pressures)`, `frame(board, drive)`.
'use strict';

const binding = require('./midair.node');

function warn(text) {
  if (text !== '') process.emitWarning(text, 'MidairWarning');
}

class Session {
  constructor(preset, method = 'uniform', options = {}) {
    warn(binding.open(this, preset, method));
    for (const [name, value] of Object.entries(options)) {
      warn(binding.set(this, name, value));
    }
  }

  // points: [[x, y, z], ...] in m; pressures: [Pa, ...], or left out for as much as the array reaches.
  solve(points, pressures) {
    const asked = pressures === undefined ? undefined : Float64Array.from(pressures);
    const answer = binding.solve(this, Float64Array.from(points.flat()), asked);
    warn(answer.warning);
    return answer;
  }
}

module.exports = { Session, frame: binding.frame };

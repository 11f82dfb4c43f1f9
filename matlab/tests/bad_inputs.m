function bad_inputs
  % bad_inputs  Makes this many bad calls. Each one must be an error of one line, and the next good call must work.
  warning('off', 'midair:scene');
  content.array.grid = struct('nx', 6, 'ny', 6, 'pitch', 0.0105);
  content.solver.name = 'naive';
  content.points = [0 0 0.12; 0.02 0 0.12];
  scene = midair.Scene(content);
  closed = midair.Scene(content);
  delete(closed);
  good = midair.solve(scene);
  P = content.points;
  q = good.drive;

  % Values that no argument may have; then values for points, for numbers of points, for drives and for names.
  never = {{1}, struct('a', 1), @sin, 'text', true, int8(3), single(1i), sparse(1), NaN(2), -Inf, zeros(1, 0), {}, ...
    struct('array', {}), closed, containers.Map(), 1e300, char(zeros(1, 3)), cell(2), 3 + 4i};
  points = {zeros(0, 3), P.', P(1, 1:2), [P; NaN 0 0.1], [P; 0 0 Inf], ones(2, 3, 2), single('a'), P + 1i, {P}, ...
    [P zeros(2, 1)], 1e9 * P, P / 0, repmat(' ', 2, 3), sparse(P), uint16(P), zeros(3, 0)};
  numbers = {-1, NaN, Inf, [1 2 3], 1i, 'a', {}, {1}, zeros(0, 1), [-5; 5], single(4), true, sparse(3), P, int32([1 2])};
  drives = {[], q(1:5), q / 0, [q q], q * 3, q * NaN, [q(1:35); Inf], 'drive', {}, zeros(0, 1), @cos, struct(), {q}, zeros(36, 0), 1};
  places = {[], 0, -1, NaN, Inf, 1.5, 1e9, 'a', {}, struct(), int8(1), true, zeros(0, 1), closed.id, scene};
  names = {'', 'sonicsurfac', 7, {}, [], struct(), 'mega64 ', NaN, char([200 201]), repmat('x', 1, 5000), @sin, true, ['ab'; 'cd']};
  scenes = [never, {'', 'array', '{"array": {}}', 'x = [', '[array]', "[array]\npreset = 'autd4'\n", char(1:255), ...
    jsonencode(rmfield(content, 'points')), repmat('[', 1, 1e4), struct('array', 5, 'points', P), ...
    setfield(content, 'points', P.'), setfield(content, 'solver', 'naive'), setfield(content, 'aray', 1), ...
    setfield(content, 'obstacles', struct('point', [0 0 1], 'normal', [0 0 1])), setfield(content, 'points', 'P'), ...
    setfield(content, 'solver', struct('name', 'nave')), setfield(content, 'points', zeros(0, 3)), ...
    setfield(content, 'points', [0 0 NaN])}];

  calls = {
    @(x) midair.Scene(x), scenes
    @(x) midair.solve(x), scenes
    @(x) midair.field(x, q, P), scenes
    @(x) midair.judge(x, q), scenes
    @(x) midair.sequence(x), [scenes {content, scene}]
    @(x) midair.encode(x, 'mega64', q), scenes
    @(x) midair.silence(x, 'mega64'), scenes
    @(x) midair.Scene(content, x), {struct(), {struct()}, containers.Map()}
    @(x) midair.solve(scene, x), [never points]
    @(x) midair.solve(scene, x, 100), [never points]
    @(x) midair.solve(scene, P, x), [numbers {1e300}]
    @(x) midair.solve(scene, P, 100, x), numbers
    @(x) midair.solve(scene, [], x), numbers
    @(x) midair.solve(scene, P, 100, 1, x), [never numbers]
    @(x) midair.field(scene, x, P), drives
    @(x) midair.field(scene, q, x), [never points]
    @(x) midair.field(x, P), [scenes drives]
    @(x) midair.judge(scene, x), drives
    @(x) midair.judge(scene, x, P, 100), drives
    @(x) midair.judge(scene, q, x, 100), [never points]
    @(x) midair.judge(scene, q, P, x), numbers
    @(x) midair.judge(scene, q, P, 100, x), numbers
    @(x) midair.encode(scene, x, q), names
    @(x) midair.encode(scene, 'mega64', x), drives([1:3 5:end])
    @(x) midair.silence(scene, x), names
    @(x) midair_mex(x), [never names numbers]
    @(x) midair_mex('open', x, ''), [scenes numbers]
    @(x) midair_mex('open', jsonencode(content), x), numbers
    @(x) midair_mex('close', x), places
    @(x) midair_mex('solve', x, P), places
    @(x) midair_mex('solve', scene.id, x), [never points]
    @(x) midair_mex('field', x, q, P), places
    @(x) midair_mex('field', scene.id, x, P), [drives never]
    @(x) midair_mex('judge', x, q), places
    @(x) midair_mex('sequence', x), places
    @(x) midair_mex('encode', x, 'mega64', q), places
    @(x) midair_mex('encode', scene.id, x, q), [names never]
    @(x) midair_mex('encode', scene.id, 'mega64', x), [drives([1:3 5:end]) never]
    @(x) midair_mex('silence', x, 'mega64'), places
  };
  made = 0;
  own = 0;
  for k = 1:size(calls, 1)
    for j = 1:numel(calls{k, 2})
      try
        calls{k, 1}(calls{k, 2}{j});
        line = '';
      catch fault
        line = fault.message;
        own = own + strncmp(fault.identifier, 'midair:', 7);
      end
      if isempty(line) || any(line == 10)
        printf('%s of value %d: "%s"\n', func2str(calls{k, 1}), j, line);
      end
      made = made + 1;
    end
    again = midair.solve(scene);
    assert(again.drive, q);
  end
  printf('%d bad calls, %d refused by midair\n', made, own);
end

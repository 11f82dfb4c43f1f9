function many_calls(rounds)
  % many_calls  Makes ten calls a round, one of them a bad one, and prints by how many kB memory grows after a tenth of them.
  warning('off', 'midair:scene');
  content.array.grid = struct('nx', 8, 'ny', 8, 'pitch', 0.0105);
  content.solver.name = 'fast';
  content.points = [0 0 0.12];
  scene = midair.Scene(content);
  resident();  % its functions are loaded before memory is compared
  for k = 1:rounds
    if k == ceil(rounds / 10), before = resident(); end
    for m = 1:4
      solution = midair.solve(scene, [0.02 * cos(k + (1:m)') 0.02 * sin(k + (1:m)') 0.12 * ones(m, 1)], 500);
    end
    midair.field(solution, solution.points);
    midair.judge(scene, solution.drive);
    midair.encode(scene, 'mega64', solution.drive);
    midair.silence(scene, 'mega64');
    another = midair.solve(content);
    try
      midair.solve(scene, [0 0 NaN]);
      error('not refused');
    catch fault
      assert(fault.identifier, 'midair:not_finite');
    end
  end
  printf('%d kB\n', resident() - before);
end

function kilobytes = resident()
  % Returns the memory of this process.
  kilobytes = sscanf(regexp(fileread('/proc/self/status'), 'VmRSS:\s*(\d+)', 'tokens', 'once'){1}, '%d');
end

function solution = solve(scene, varargin)
  % midair.solve  Computes a drive, so that the pressures at points are what the scene requests.
  %
  %   solution = midair.solve(scene) solves the request of a scene: a struct, a text or a midair.Scene.
  %   solution = midair.solve(scene, points, pressures, weights) solves for other points M x 3 in m, for pressures in Pa
  %   (peak) and for weights. Both have one number for each point, or one for all. Without pressures, or with [], all points
  %   get the level that the array can give to all of them.
  %
  %   solution is a struct:
  %     drive      N x 1, complex: amplitude (at most 1) and phase of each transducer, as the board can play them
  %     points     M x 3 in m
  %     pressures  M x 1, complex, in Pa
  %     status     'done', 'missed' (by more than 1 %) or 'out_of_steps'
  %     steps      number of steps
  %     scale      factor that the supply voltage must apply to the drive, counted in pressures and metrics
  %     metrics    accuracy, sigma, uniformity, level, residual and leak, as docs/conventions.md defines them
  %     scene      the midair.Scene
  %
  %   The method and its options are those of the scene: scene.solver.name = 'greedy'.
  %
  %   Example:
  %     scene.array.preset = 'autd3';
  %     solution = midair.solve(scene, [-0.02 0 0.15; 0.02 0 0.15], 1500);
  %     loudest = max(abs(solution.pressures));
  %
  %   See also midair.Scene, midair.field, midair.judge, midair.encode
  if ~isobject(scene), scene = midair.opened(scene, varargin{:}); end
  solution = midair_mex('solve', scene.id, varargin{:});
  solution.scene = scene;
end

function metrics = judge(scene, drive, varargin)
  % midair.judge  Computes the metrics of any drive, in double precision.
  %
  %   metrics = midair.judge(scene, drive) refers to the request of the scene.
  %   metrics = midair.judge(scene, drive, points, pressures, weights) refers to other points, as in midair.solve.
  %
  %   metrics is a struct of accuracy, sigma, uniformity, level, residual and leak, as docs/conventions.md defines them.
  %
  %   Example:
  %     scene.array.preset = 'autd3';
  %     metrics = midair.judge(scene, ones(249, 1), [-0.02 0 0.15; 0.02 0 0.15], 1500);
  %
  %   See also midair.solve, midair.field
  if ~isobject(scene), scene = midair.opened(scene, varargin{:}); end
  metrics = midair_mex('judge', scene.id, double(drive(:)), varargin{:});
end

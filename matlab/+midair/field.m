function pressures = field(scene, drive, points)
  % midair.field  Computes the complex pressures of a drive at any points.
  %
  %   pressures = midair.field(scene, drive, points) returns pressures M x 1 in Pa (peak) at points M x 3 in m.
  %   pressures = midair.field(solution, points) takes scene and drive of a solution, times its scale.
  %
  %   Example:
  %     scene.array.preset = 'autd3';
  %     solution = midair.solve(scene, [0 0 0.15], 2000);
  %     [x, y] = meshgrid(linspace(-0.05, 0.05, 100));
  %     p = midair.field(solution, [x(:) y(:) 0.15 + 0 * x(:)]);
  %     picture = reshape(abs(p), size(x));
  %
  %   See also midair.solve, midair.judge
  if nargin == 2, [points, drive, scene] = deal(drive, scene.drive * scene.scale, scene.scene); end
  if ~isobject(scene), scene = midair.opened(scene, points); end
  pressures = midair_mex('field', scene.id, double(drive(:)), points);
end

function scene = opened(scene, points, varargin)
  % midair.opened  Reads a scene as midair.Scene does. A struct without points gets these. The functions of midair call it.
  if nargin > 1 && isstruct(scene) && ~isfield(scene, 'points'), scene.points = points; end
  scene = midair.Scene(scene);
end

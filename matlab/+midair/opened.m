function scene = opened(scene, points)
  % midair.opened  Reads a scene as midair.Scene does. A struct without points gets these. The functions of midair call it.
  if isstruct(scene) && ~isfield(scene, 'points') && ~isempty(points), scene.points = points; end
  scene = midair.Scene(scene);
end

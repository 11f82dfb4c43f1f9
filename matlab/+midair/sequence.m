function frames = sequence(scene)
  % midair.sequence  Solves the motion of a scene file with [motion], frame by frame.
  %
  %   frames = midair.sequence(scene) returns a struct for N transducers, M points and T frames:
  %     drives   N x T, complex
  %     points   M x 3 x T in m
  %     targets  M x T in Pa; 0 stands for a point that is absent
  %     rate     frames per second
  %     closed   whether the last frame continues to the first
  %
  %   The page docs/motion.md lists the keys of [motion].
  %
  %   Example:
  %     scene.array.preset = 'sonicsurface';
  %     scene.motion.rate = 200;
  %     scene.motion.path = {struct('kind', 'circle', 'center', [0 0 0.12], 'radius', 0.01, 'frequency', 10)};
  %     frames = midair.sequence(scene);
  %     bytes = midair.encode(scene, 'sonicsurface', frames.drives);
  %
  %   See also midair.solve, midair.encode
  if ~isobject(scene), scene = midair.Scene(scene); end
  frames = midair_mex('sequence', scene.id);
  frames.points = permute(frames.points, [2 1 3]);
end

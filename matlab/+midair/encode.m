function frames = encode(scene, kind, drives)
  % midair.encode  Returns the bytes that play drives on boards.
  %
  %   frames = midair.encode(scene, kind, drives) returns a column of uint8 for each column of drives N x T. kind is the
  %   name of a board, such as 'sonicsurface'. As many boards are assumed as the array of the scene needs.
  %
  %   The page docs/boards.md lists the boards, and how bytes reach them. A board plays its last frame until it gets
  %   another one: write the bytes of midair.silence at the end.
  %
  %   Example:
  %     scene.array.preset = 'sonicsurface';
  %     solution = midair.solve(scene, [0 0 0.12]);
  %     frame = midair.encode(solution.scene, 'sonicsurface', solution.drive);
  %
  %   See also midair.silence, midair.solve, midair.sequence
  if ~isobject(scene), scene = midair.Scene(scene); end
  frames = midair_mex('encode', scene.id, kind, double(drives));
end

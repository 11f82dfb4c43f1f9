function bytes = silence(scene, kind)
  % midair.silence  Returns the bytes that switch boards off from any state, a column of uint8.
  %
  %   bytes = midair.silence(scene, kind) takes the array of a scene, and the name of a board as in midair.encode.
  %
  %   See also midair.encode
  if ~isobject(scene), scene = midair.Scene(scene); end
  bytes = midair_mex('silence', scene.id, kind);
end

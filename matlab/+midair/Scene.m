classdef Scene < handle
  % midair.Scene  A scene that is read once and solved many times.
  %
  %   scene = midair.Scene(content) reads the text of a scene file, in TOML or JSON, or a struct with the same keys.
  %   scene = midair.Scene(content, folder) also reads the files that the scene names, relative to this folder.
  %
  %   In a struct, points may be a matrix M x 3 of positions in m. Other lists of tables, such as obstacles, are struct
  %   arrays or cells of structs. A list of one table must be a cell.
  %
  %   The functions of midair take a scene, a struct or a text. A struct or a text is read again at each call. A scene
  %   keeps the memory of its solves, and reports each kind of warning once. It is closed when its last variable is cleared.
  %
  %   Errors have the identifier midair:CODE, with the codes of docs/errors.md and _ instead of -.
  %
  %   Example:
  %     content.array.preset = 'autd3';
  %     content.solver.name = 'fast';
  %     content.points = [-0.02 0 0.15];
  %     scene = midair.Scene(content);
  %     for x = linspace(-0.02, 0.02, 5)
  %       solution = midair.solve(scene, [x 0 0.15], 2000);
  %     end
  %
  %   See also midair.solve, midair.field, midair.judge, midair.sequence, midair.encode
  properties (Hidden)
    id = 0  % the place of the session in midair_mex; public, because Octave runs delete outside of the class after `clear -f`
  end
  methods
    function scene = Scene(content, folder)
      if nargin < 2, folder = ''; end
      if isstruct(content) && isfield(content, 'points') && isnumeric(content.points)
        table = @(row) struct('position', double(row));
        content.points = cellfun(table, num2cell(content.points, 2), 'UniformOutput', false);
      end
      if ~ischar(content) && ~isa(content, 'string'), content = jsonencode(content); end
      scene.id = midair_mex('open', char(content), char(folder));
    end

    function delete(scene)
      if scene.id > 0, midair_mex('close', scene.id); end
      scene.id = 0;
    end
  end
end

function write_arrays(name, varargin)
  % write_arrays  Appends arrays to a file, each in its class.
  file = fopen(name, 'a');
  for k = 1:numel(varargin)
    fwrite(file, varargin{k}, class(varargin{k}));
  end
  fclose(file);
end

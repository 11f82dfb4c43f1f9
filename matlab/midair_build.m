function midair_build(library)
  % midair_build  Compiles midair_mex.c with midair's C library. Run it in the folder of this file.
  %
  %   midair_build(library) takes the static library of this file name. By default it is ../target/release/libmidair.a,
  %   which `make capi` builds.
  %
  %   The compiled file contains the library: from then on, midair needs only this folder.
  here = fileparts(mfilename('fullpath'));
  if nargin < 1, library = fullfile(here, '..', 'target', 'release', 'libmidair.a'); end
  mex(['-I' fullfile(here, '..', 'capi', 'include')], fullfile(here, 'midair_mex.c'), library);
end

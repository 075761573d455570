% Adapter of `simulate_case.m`, with the kit `pantocheck_serve.m`.
%
% Try it:  pantocheck system check 'octave-cli --quiet examples/octave_catenary/adapter.m'

addpath(fileparts(mfilename('fullpath')));
pantocheck_serve('string catenary in Octave', '1.0', @simulate_case);

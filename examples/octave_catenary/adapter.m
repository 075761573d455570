% Adapter of `simulate_case.m`, with the kit `pantocheck_serve.m`.
%
% Try it:  pantocheck system check 'octave-cli --quiet examples/octave_catenary/adapter.m'

addpath(fileparts(mfilename('fullpath')));
% Features that the simulator takes into account; a case with another one is skipped.
features = {'bending_stiffness', 'chain', 'dropper_mass', 'droppers', 'gradients', 'listed_spans', 'presag', ...
  'rayleigh_damping', 'single_supports', 'steady_arm_mass', 'steady_arms', 'support_dampers', ...
  'surveyed_wire_heights', 'wire_height'};
pantocheck_serve('string catenary in Octave', '1.0', @simulate_case, features);

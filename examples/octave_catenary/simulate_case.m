function record = simulate_case(given)
% Small catenary simulator: two wires in finite differences, droppers that slacken, a pantograph of lumped masses.
%
% Deflections w [m] are positive upwards and start from the initial state of the line. The time integration is explicit
% (semi-implicit Euler). At rest, the contact wire is a string between its droppers and arms. These are the equations of
% examples/string_catenary, apart from the bending of the wire at rest.
  train = given.pantographs(1);
  speed = given.speed_km_h / 3.6;
  step = given.discretisation.time_step_s;
  k_contact = train.contact.stiffness_N_m;
  uplift_force = train.uplift_force_N;
  line = build_line(given.line, given.derived.line, given.discretisation.element_m);
  substeps = ceil(step / stable_step(line, k_contact));
  dt = step / substeps;

  % Rest under the uplift force at the start: 4 s with an additional mass coefficient of 3 1/s.
  at = locate(line, train.start_m);
  for n = 1:round(4 / dt)
    line = step_line(line, dt, at, uplift_force, 3);
  end
  line.v(:) = 0;

  chain = train.chain;
  m = chain.masses_kg(:);
  k = chain.stiffness_N_m(:);
  c = chain.damping_N_s_m(:);
  force = zeros(size(m));
  force(find_mass(chain)) = uplift_force;
  base = given.derived.train.pantographs(1).working_height_m;
  z = zeros(size(m));
  v = zeros(size(m));
  z(end) = at * (line.rest + line.w(:, 1)) + uplift_force / k_contact;
  for i = numel(m):-1:2
    z(i - 1) = z(i) - (sum(force(i:end)) - uplift_force) / k(i);
  end

  steps = round((train.end_m - train.start_m) / speed / step);
  x = zeros(steps, 1);
  contact = zeros(steps, 1);
  height = zeros(steps, 1);
  uplift = zeros(steps, numel(line.support_position));
  contact_force = uplift_force;
  for n = 1:steps
    for substep = 1:substeps
      place = train.start_m + speed * ((n - 1) * step + substep * dt);
      at = locate(line, place);
      line = step_line(line, dt, at, contact_force, 0);
      spring = k .* (z - [base; z(1:end-1)]) + c .* (v - [0; v(1:end-1)]);
      load = force - spring + [spring(2:end); 0];
      load(end) = load(end) - contact_force;
      v = v + dt * load ./ m;
      z = z + dt * v;
      wire = at * (line.rest + line.w(:, 1));
      contact_force = k_contact * max(0, z(end) - wire);
    end
    x(n) = place;
    contact(n) = contact_force;
    height(n) = wire;
    uplift(n, :) = (line.arms * line.w(:, 1))';
  end
  record = struct( ...
    'time_s', (1:steps)' * step, 'position_m', x, 'force_N', contact, 'contact_height_m', height, ...
    'support_position_m', line.support_position, 'uplift_m', uplift, ...
    'start', struct('place_m', train.start_m, 'ramp_m', 0, 'state', 'equilibrium_under_uplift_forces'), ...
    'dt_s', step, 'element_m', given.discretisation.element_m, ...
    'note', 'Finite differences, explicit time stepping.');
end

function line = build_line(data, derived, element)
% Contact wire (column 1) and messenger wire (column 2), droppers, steady arms and messenger supports.
  droppers = derived.droppers;
  arms = derived.steady_arms;
  supports = derived.messenger_supports;
  cells = round(derived.contact_wire.end_m / element);
  line.n = cells + 1;
  line.h = derived.contact_wire.end_m / cells;
  inner = 2:cells;
  second = sparse([inner inner inner], [inner - 1, inner, inner + 1], kron([1 -2 1], ones(1, cells - 1)), line.n, line.n);
  wires = {data.contact_wire, data.messenger_wire};
  damping = {data.damping.contact_wire, data.damping.messenger_wire};
  for i = 1:2
    tension = wires{i}.tension_N / line.h;
    bending = wires{i}.bending_stiffness_N_m2 / line.h^3;
    line.largest_stiffness(i) = 4 * tension + 16 * bending;
    line.force{i} = tension * second - bending * second * second;
    line.alpha(i) = damping{i}.mass_coefficient_1_s;
    line.beta(i) = damping{i}.stiffness_coefficient_s;
    line.mass(:, i) = repmat(wires{i}.mass_kg_m * line.h, line.n, 1);
  end
  line.w = zeros(line.n, 2);
  line.v = zeros(line.n, 2);
  x = flatten(droppers.position_m);
  half = flatten(droppers.mass_kg) / 2;
  line.droppers = locate(line, x);
  line.mass(:, 1) = line.mass(:, 1) + line.droppers' * (half + droppers.lower_clamp_kg);
  line.mass(:, 2) = line.mass(:, 2) + line.droppers' * (half + droppers.upper_clamp_kg);
  line.dropper_stiffness = flatten(droppers.stiffness_N_m);
  line.dropper_beta = droppers.stiffness_coefficient_s;
  line.preload = flatten(droppers.vertical_force_N);
  line.support_position = flatten(arms.position_m);
  count = numel(line.support_position);
  line.arms = locate(line, line.support_position);
  line.arm_stiffness = spread(arms.vertical_stiffness_N_m, count);
  line.arm_beta = arms.stiffness_coefficient_s;
  line.mass(:, 1) = line.mass(:, 1) + line.arms' * spread(arms.mass_kg, count);
  line.supports = locate(line, flatten(supports.position_m));
  line.support_stiffness = spread(supports.vertical_stiffness_N_m, size(line.supports, 1));
  line.support_damping = spread(supports.vertical_damper_N_s_m, size(line.supports, 1));

  % Height at rest: a string between anchors, droppers, and arms that carry a share of the wire.
  limits = flatten(derived.span_limits_m);
  at_limits = flatten(derived.contact_wire.height_m);
  held = [true; flatten(arms.vertical_force_N) ~= 0; true];
  points = sortrows([x, flatten(droppers.contact_wire_height_m); limits(held), at_limits(held)]);
  grid = (0:cells)' * line.h;
  straight = interp1(points(:, 1), points(:, 2), grid, 'linear', 'extrap');
  left = interp1(points(:, 1), (1:size(points, 1))', grid, 'linear', 'extrap');
  left = min(max(floor(left), 1), size(points, 1) - 1);
  sag = 9.81 * data.contact_wire.mass_kg_m / (2 * data.contact_wire.tension_N);
  line.rest = straight - sag * (grid - points(left, 1)) .* (points(left + 1, 1) - grid);
end

function matrix = locate(line, x)
% Linear interpolation at positions along the track; its transpose distributes forces to the nodes.
  x = x(:);
  node = min(max(floor(x / line.h), 0), line.n - 2);
  weight = x / line.h - node;
  rows_ = (1:numel(x))';
  matrix = sparse([rows_; rows_], [node + 1; node + 2], [1 - weight; weight], numel(x), line.n);
end

function dt = stable_step(line, k_contact)
% Largest stable time step [s], with a margin.
  point = max(line.dropper_stiffness) + max([line.arm_stiffness; line.support_stiffness; k_contact]);
  dt = 0.5 / sqrt(max((line.largest_stiffness + 2 * point) ./ min(line.mass)));
end

function line = step_line(line, dt, at, force, extra_damping)
% Advance both wires by one time step, with the contact force upwards at a point.
  w = line.w;
  v = line.v;
  stretch = line.droppers * (w(:, 2) - w(:, 1));
  rate = line.droppers * (v(:, 2) - v(:, 1));
  tension = max(0, line.preload + line.dropper_stiffness .* (stretch + line.dropper_beta * rate));
  change = line.droppers' * (tension - line.preload);
  arm = line.arm_stiffness .* (line.arms * (w(:, 1) + line.arm_beta * v(:, 1)));
  support = line.support_stiffness .* (line.supports * w(:, 2)) + line.support_damping .* (line.supports * v(:, 2));
  load = [change - line.arms' * arm + at' * force, -change - line.supports' * support];
  for i = 1:2
    load(:, i) = load(:, i) + line.force{i} * (w(:, i) + line.beta(i) * v(:, i));
  end
  v = v + dt * (load ./ line.mass - (line.alpha + extra_damping) .* v);
  v([1 end], :) = 0;
  line.v = v;
  line.w = w + dt * v;
end

function index = find_mass(chain)
% Mass of the uplift force, given by its name or by its number from the ground.
  if ischar(chain.uplift_force_on)
    index = find(strcmp(chain.names, chain.uplift_force_on));
  else
    index = chain.uplift_force_on;
  end
end

function values = flatten(given)
% Column of all numbers: lists by span are a matrix if they are equally long, and a cell otherwise.
  if iscell(given)
    values = cell2mat(cellfun(@(part) part(:), given(:), 'UniformOutput', false));
  elseif isvector(given)
    values = given(:);
  else
    given = given';
    values = given(:);
  end
end

function values = spread(given, count)
% A value of arms or supports is one number, or a list if they differ.
  values = flatten(given);
  if numel(values) == 1
    values = repmat(values, count, 1);
  end
end

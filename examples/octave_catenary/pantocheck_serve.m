function pantocheck_serve(name, version, simulate, features)
% Kit for adapters in GNU Octave and MATLAB: messages, record files and digests.
%
% `simulate` receives a case as a struct, as jsondecode reads it, and returns a record, a struct with evenly spaced
% samples in SI units. A row is a sample, a column a pantograph or a support:
%
%   time_s, position_m, force_N                         required; the force is unfiltered
%   contact_height_m, support_position_m, uplift_m      empty if they are not computed
%   start                                               struct with place_m, ramp_m and state
%   dt_s, element_m, note                               printed in reports
%
% `features` lists what the simulator takes into account, by the names in docs/systems.md: {'chain', 'droppers'}. A case
% that uses another feature is skipped before `simulate` is called. `simulate` calls error('pantocheck:skip', reason) for
% any other case that it does not support: verdict `skip`. Any other error becomes the verdict `error` of the case. Write a log to the standard error: fprintf(2, ...).
%
% Tested with GNU Octave 7. The branches for MATLAB could not be run where this was written; MATLAB must be started so
% that it can read its standard input (matlab -nodisplay -r).
  while true
    line = read_line();
    if ~ischar(line)
      break
    end
    message = jsondecode(line);
    if strcmp(message.message, 'stop')
      break
    elseif strcmp(message.message, 'start')
      answer = struct('message', 'started', 'protocol', 'pantocheck.command/1', 'name', name, 'version', version);
      answer.features = features;
    else
      names = fieldnames(message);
      given = message.(names{strcmpi(names, 'xcase')});  % jsondecode renames the keyword `case`
      answer = run_case(name, version, simulate, features, given);
      answer.id = message.id;
    end
    fprintf(1, '%s\n', jsonencode(answer));
    if is_octave()
      fflush(stdout);
    end
  end
end

function answer = run_case(name, version, simulate, features, given)
% Answer to a message `run`, without its number.
  try
    missing = setdiff(given.features, features);
    if ~isempty(missing)
      error('pantocheck:skip', 'the simulator neglects %s', strjoin(missing(:)', ', '));
    end
    begin = tic();
    record = simulate(given);
    write_record(record, given, name, version, toc(begin));
    files = struct('sidecar', describe_file('record.toml'), 'table', describe_file('record.csv'));
    answer = struct('message', 'delivered', 'record', files);
    answer.notes = {record.note};
  catch failure
    if strcmp(failure.identifier, 'pantocheck:skip')
      answer = struct('message', 'skipped', 'reason', failure.message);
    else
      answer = struct('message', 'errored', 'reason', [failure.message describe_place(failure)]);
    end
  end
end

function text = describe_place(failure)
% Function and line that raised an error.
  text = '';
  if ~isempty(failure.stack)
    text = sprintf(' (%s, line %d)', failure.stack(1).name, failure.stack(1).line);
  end
end

function write_record(record, given, name, version, wall_s)
% Write table and sidecar into the working folder.
  names = {'time_s'};
  for channel = {'position_m', 'force_N', 'contact_height_m', 'uplift_m'}
    parts = regexp(channel{1}, '^(.*)_([^_]+)$', 'tokens');
    parts = parts{1};
    for number = 1:size(record.(channel{1}), 2)
      names{end + 1} = sprintf('%s_%d_%s', parts{1}, number, parts{2});
    end
  end
  samples = [record.time_s, record.position_m, record.force_N, record.contact_height_m, record.uplift_m];
  table = fopen('record.csv', 'w');
  fprintf(table, '%s\n', strjoin(names, ','));
  fprintf(table, [strjoin(repmat({'%.9g'}, 1, numel(names)), ',') '\n'], samples');
  fclose(table);
  supports = {};
  if ~isempty(record.support_position_m)
    supports = {['support_position_m = ' list_numbers(record.support_position_m)]};
  end
  lines = {
    'schema = "pantocheck.record/1"', ['case = ' jsonencode(given.id)], ...
    ['case_digest = ' jsonencode(given.case_digest)], 'file = "record.csv"', ...
    sprintf('speed_km_h = %.9g', given.speed_km_h), sprintf('pantographs = %d', size(record.force_N, 2)), ...
    ['evaluated_m = ' list_numbers(given.evaluated_m)], 'filter_applied_Hz = "none"', ...
    supports{:}, ...
    '[system]', ['name = ' jsonencode(name)], ['version = ' jsonencode(version)], ...
    '[start]', sprintf('place_m = %.9g', record.start.place_m), sprintf('ramp_m = %.9g', record.start.ramp_m), ...
    ['state = ' jsonencode(record.start.state)], ...
    '[run]', sprintf('wall_s = %.3f', wall_s), sprintf('simulated_s = %.9g', record.time_s(end)), ...
    sprintf('dt_s = %.9g', record.dt_s), sprintf('element_m = %.9g', record.element_m)};
  sidecar = fopen('record.toml', 'w');
  fprintf(sidecar, '%s\n', lines{:});
  fclose(sidecar);
end

function text = list_numbers(numbers)
  text = ['[' strjoin(arrayfun(@(x) sprintf('%.9g', x), numbers(:)', 'UniformOutput', false), ', ') ']'];
end

function entry = describe_file(name)
% Name and SHA-256 of a file.
  file = fopen(name, 'r');
  content = fread(file, Inf, 'uint8=>uint8')';
  fclose(file);
  if is_octave()
    digest = hash('sha256', char(content));
  else
    engine = java.security.MessageDigest.getInstance('SHA-256');
    digest = sprintf('%02x', typecast(engine.digest(content), 'uint8'));
  end
  entry = struct('file', name, 'sha256', digest);
end

function line = read_line()
% Next line of the standard input; -1 at its end. Octave's fgetl would wait for the line after it.
  try
    line = input('', 's');
  catch
    line = -1;
  end
end

function answer = is_octave()
  answer = exist('OCTAVE_VERSION', 'builtin') ~= 0;
end

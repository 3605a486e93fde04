% Reads a marginal density of a run of pbif in Octave or MATLAB and draws it along the sweep:
%
%   pbif sweep sweeps/bistable.toml
%   pbif export output/bistable --format csv
%   octave examples/octave/read_run.m output/bistable-csv/p_x.csv marginal.png
%
% The table has a row a cell: parameter, coordinate of the cell's centre, density, standard error.
arguments = argv();
table = dlmread(arguments{1}, ',', 1, 0);
values = unique(table(:, 1));
x = unique(table(:, 2));
% Rows of one value stand together, cells ascending.
p = reshape(table(:, 3), numel(x), numel(values));
printf('%d values from %g to %g, %d cells, highest density %g\n', numel(values), values(1), values(end), numel(x), max(p(:)));
if numel(arguments) > 1
  figure('visible', 'off');
  pcolor(values, x, p);
  shading flat;
  colorbar;
  xlabel('parameter');
  ylabel('x');
  print(arguments{2}, '-dpng');
end

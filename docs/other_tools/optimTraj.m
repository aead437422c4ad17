% Stand-in for OptimTraj's entry point: reads its problem structure, and solves by separated Hermite-Simpson collocation.
% Fixed times, bounds, dynamics and pathObj are supported; nothing else is. OptimTraj itself calls MATLAB's fmincon.
function soln = optimTraj (problem)
  assert (strcmp (problem.options.method, 'hermiteSimpson'));
  b = problem.bounds;
  assert (b.initialTime.low == b.initialTime.upp && b.finalTime.low == b.finalTime.upp);
  N = problem.options.hermiteSimpson.nSegment;
  M = 2 * N + 1;  % knots and midpoints
  t = linspace (b.initialTime.low, b.finalTime.low, M);
  h = (t(end) - t(1)) / N;
  nx = rows (problem.guess.state);
  nu = rows (problem.guess.control);
  states = @(z) reshape (z(1:nx*M), nx, M);
  controls = @(z) reshape (z(nx*M+1:end), nu, M);
  weights = h / 6 * [1, repmat([4, 2], 1, N - 1), 4, 1];
  objective = @(z) problem.func.pathObj (t, states (z), controls (z)) * weights';
  defects = @(z) hermite_simpson (h, states (z), problem.func.dynamics (t, states (z), controls (z)));

  lower = repmat (b.state.low, 1, M);  upper = repmat (b.state.upp, 1, M);
  lower(:,1) = b.initialState.low;     upper(:,1) = b.initialState.upp;
  lower(:,M) = b.finalState.low;       upper(:,M) = b.finalState.upp;
  lower = [lower(:); repmat(b.control.low, 1, M)(:)];
  upper = [upper(:); repmat(b.control.upp, 1, M)(:)];
  guess = problem.guess;
  z = [(interp1 (guess.time, guess.state', t)')(:); (interp1 (guess.time, guess.control', t)')(:)];
  z = quadratic_program_steps (objective, defects, min (max (z, lower), upper), lower, upper);
  u = controls (z);
  soln.info.objVal = objective (z);
  soln.info.defect = norm (defects (z), inf);
  soln.grid = struct ('time', t, 'state', states (z), 'control', u);
  soln.interp.control = @(s) quadratic_pieces (t, u, s);
end

function r = hermite_simpson (h, x, f)
  k = 1:2:columns (x) - 2;  c = k + 1;  n = k + 2;
  r = [x(:,n) - x(:,k) - h/6*(f(:,k) + 4*f(:,c) + f(:,n)), x(:,c) - (x(:,k) + x(:,n))/2 - h/8*(f(:,k) - f(:,n))](:);
end

% Newton steps on the optimality conditions. The objective is a sum of squares, and the defects' curvature is left out.
function z = quadratic_program_steps (objective, defects, z, lower, upper)
  free = find (upper > lower);
  difference = @(f, z, d, i) (f(z + d*((1:numel (z))' == i)) - f(z)) / d;
  zero = zeros (size (z));
  curvature = arrayfun (@(i) 2*(objective ((1:numel (z))' == i) - objective (zero)), free);
  H = diag (curvature + 1e-3*max (curvature));
  penalty = 1;
  for iteration = 1:80
    c = defects (z);
    J = cell2mat (arrayfun (@(i) difference (defects, z, 1e-6, i), free', 'UniformOutput', false));
    step = [H, J'; J, -1e-9*eye(numel (c))] \ -[curvature.*z(free); c];
    p = step(1:numel (free));
    if norm (c, inf) < 1e-6 && norm (p, inf) < 1e-2, return, end  % it converges linearly
    penalty = max (penalty, 1.1*norm (step(numel (free)+1:end), inf));
    merit = @(z) objective (z) + penalty*norm (defects (z), 1);
    slope = (curvature.*z(free))'*p - penalty*norm (c, 1);
    a = 1;
    while true
      trial = z;
      trial(free) = min (max (z(free) + a*p, lower(free)), upper(free));
      if a < 1e-6 || merit (trial) <= merit (z) + 1e-4*a*slope, break, end
      a = a / 2;
    end
    z = trial;
  end
  error ('the stand-in of optimTraj did not converge');
end

function v = quadratic_pieces (t, u, s)
  h = t(3) - t(1);
  k = min (floor ((s - t(1)) / h), (numel (t) - 3)/2);
  r = (s - t(1)) / h - k;
  i = 2*k + 1;
  v = u(:,i).*(1 - r).*(1 - 2*r) + u(:,i+1)*4.*r.*(1 - r) + u(:,i+2).*r.*(2*r - 1);
end

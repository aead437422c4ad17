% Stand-in for GPOPS-II's entry point, which is sold under a licence: Legendre-Gauss-Radau collocation of one phase.
% Fixed times, bounds, dynamics, integrand and endpoint are supported. The mesh is fixed: nine intervals of three points.
function output = gpops2 (setup)
  intervals = 9;  % so that knots stand where the limit of Bryson and Denham's problem begins and ends
  points = [-1; (1 - sqrt(6))/5; (1 + sqrt(6))/5];
  weights = [2/9; (16 + sqrt(6))/18; (16 - sqrt(6))/18];
  D = differentiation ([points; 1])(1:3,:);
  b = setup.bounds.phase;  g = setup.guess.phase;
  assert (b.initialtime.lower == b.initialtime.upper && b.finaltime.lower == b.finaltime.upper);
  h = (b.finaltime.lower - b.initialtime.lower) / intervals;
  t = (b.initialtime.lower + h*((0:intervals-1) + (points + 1)/2))(:);
  weights = repmat (weights, intervals, 1)*h/2;
  M = numel (t);  nx = columns (b.state.lower);  nu = columns (b.control.lower);
  states = @(z) reshape (z(1:(M+1)*nx), M + 1, nx);
  controls = @(z) reshape (z((M+1)*nx+1:end), M, nu);

  function c = continuous (z)
    input.phase = struct ('time', t, 'state', states (z)(1:M,:), 'control', controls (z));
    c = setup.functions.continuous (input);
    assert (size (c.dynamics), [M, nx]);
    assert (size (c.integrand), [M, 1]);
  end
  function value = objective (z)
    x = states (z);
    input.phase = struct ('initialtime', b.initialtime.lower, 'finaltime', b.finaltime.lower, ...
      'initialstate', x(1,:), 'finalstate', x(end,:), 'integral', weights'*continuous (z).integrand);
    value = setup.functions.endpoint (input).objective;
  end
  function r = defects (z)
    x = states (z);  f = continuous (z).dynamics;  r = [];
    for k = 1:intervals
      i = 3*k - (2:-1:0);
      r = [r; (D*x([i, 3*k+1],:) - h/2*f(i,:))(:)];
    end
  end

  lower = repmat (b.state.lower, M + 1, 1);  upper = repmat (b.state.upper, M + 1, 1);
  lower(1,:) = b.initialstate.lower;         upper(1,:) = b.initialstate.upper;
  lower(end,:) = b.finalstate.lower;         upper(end,:) = b.finalstate.upper;
  lower = [lower(:); repmat(b.control.lower, M, 1)(:)];
  upper = [upper(:); repmat(b.control.upper, M, 1)(:)];
  z = [interp1(g.time, g.state, [t; b.finaltime.lower])(:); interp1(g.time, g.control, t)(:)];
  z = sqp (min (max (z, lower), upper), @objective, @defects, [], lower, upper, 400, 1e-9);
  integral = weights'*continuous (z).integrand;
  assert (integral >= b.integral.lower && integral <= b.integral.upper);
  output.result.objective = objective (z);
  output.result.solution.phase = struct ('time', [t; b.finaltime.lower], 'state', states (z), ...
    'control', controls (z), 'integral', integral);
end

% Derivatives of the Lagrange polynomials of some points at these points, by barycentric weights.
function D = differentiation (s)
  distance = s - s' + eye (numel (s));
  w = 1 ./ prod (distance, 2);
  D = (w' ./ w) ./ distance;
  D(1:numel (s)+1:end) = 0;
  D -= diag (sum (D, 2));
end

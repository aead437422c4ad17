% Rates of [x; q; dx; dq]: a cart of mass m1 and a pole of length l with the mass m2 at its end; q is 0 where it hangs.
function rate = cartPoleDynamics (state, force, p)
  q = state(2,:);  dx = state(3,:);  dq = state(4,:);
  below = p.m1 + p.m2*sin (q).^2;
  ddx = (force + p.m2*sin (q).*(p.g*cos (q) + p.l*dq.^2)) ./ below;
  ddq = -(force.*cos (q) + (p.m1 + p.m2)*p.g*sin (q) + p.m2*p.l*cos (q).*sin (q).*dq.^2) ./ (p.l*below);
  rate = [dx; dq; ddx; ddq];
end

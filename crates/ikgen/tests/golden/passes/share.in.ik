ikgen 1
class "example"
variables 1
free [0]
snap 0.0
slack 0.0
{
  # used twice here
  circle(px * px + py * py, pz, px * px + py * py - 1.0) -> c1 s1 {
    # used twice in the inner block only
    mirror(c1 * r00 + s1 * r10, sqrt(c1 * r00 + s1 * r10)) -> c2 s2 {
      emit angle(c2 * s1, s2 * s1)
    }
    zero(s1, 1e-9) {
      emit angle(cos(free0), sin(free0))
    } else {
      emit angle(cos(free0), pz)
    }
  }
}

ikgen 1
class "example"
variables 1
free [0]
snap 0.0
slack 0.0
{
  # used twice here
  let t1 = px * px + py * py
  circle(t1, pz, t1 - 1.0) -> c1 s1 {
    # used twice in the inner block only
    let t2 = c1 * r00 + s1 * r10
    mirror(t2, sqrt(t2)) -> c2 s2 {
      emit angle(s1 * c2, s1 * s2)
    }
    let t3 = cos(free0)
    zero(s1, 1e-9) {
      emit angle(t3, sin(free0))
    } else {
      emit angle(t3, pz)
    }
  }
}

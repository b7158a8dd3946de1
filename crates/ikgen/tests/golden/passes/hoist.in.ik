ikgen 1
class "example"
variables 1
free [0]
snap 0.0
slack 0.0
{
  align(px, py) -> c1 s1 {
    let a = r00 * r11
    align(c1 * a, s1 + r22 * pz) -> c2 s2 {
      # leaves both loops, one loop, none
      let b = c1 * s1 + r22 * pz
      first {
        emit angle(c2 * (b + 1.0), s2)
      } else {
        # a branch is not left
        emit angle(min(r00, r01), max(c1, px / py))
      }
    }
  }
}

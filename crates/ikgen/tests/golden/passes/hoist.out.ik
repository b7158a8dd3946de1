ikgen 1
class "example"
variables 1
free [0]
snap 0.0
slack 0.0
{
  let a = r00 * r11
  let h1 = r22 * pz
  align(px, py) -> c1 s1 {
    let b = c1 * s1 + h1
    let h2 = b + 1.0
    align(c1 * a, s1 + h1) -> c2 s2 {
      # leaves both loops, one loop, none
      let h3 = c2 * h2
      first {
        emit angle(h3, s2)
      } else {
        # a branch is not left
        emit angle(min(r00, r01), max(c1, px / py))
      }
    }
  }
}

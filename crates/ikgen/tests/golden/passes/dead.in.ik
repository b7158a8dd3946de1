ikgen 1
class "example"
variables 1
free [0]
snap 0.0
slack 0.0
{
  let unused = px * py
  let only_for_unused = px
  let also_unused = only_for_unused + 1.0
  align(px, py) -> c1 s1 {
    # nothing is emitted here
    let x = c1 * s1
  }
  quadratic(px, py, pz) -> d {
    zero(d, 1e-9) {
    } else {
    }
    emit angle(d, py)
  }
}

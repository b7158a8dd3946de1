ikgen 1
class "example"
variables 1
free [0]
snap 0.0
slack 0.0
{
  # constants meet, neutral elements go, signs move outward
  let a = 2.0 * 3.0
  let b = px * 1.0 + 0.0 * py
  let c = -(-pz) - (r00 - r00)
  zero(a - 6.0, 1e-9) {
    align(a * (0.5 * b), 0.0 - c) -> c1 s1 {
      emit angle(c1, -s1 * -1.0)
    }
  } else {
    emit angle(px, py)
  }
}

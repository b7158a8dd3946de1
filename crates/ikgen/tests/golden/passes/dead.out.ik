ikgen 1
class "example"
variables 1
free [0]
snap 0.0
slack 0.0
{
  quadratic(px, py, pz) -> d {
    emit angle(d, py)
  }
}

ikgen 1
class "example"
variables 1
free [0]
snap 0.0
slack 0.0
{
  # constants meet, neutral elements go, signs move outward
  align(3.0 * px, -pz) -> c1 s1 {
    emit angle(c1, s1)
  }
}

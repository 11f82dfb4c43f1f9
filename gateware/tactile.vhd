-- A SonicSurface with its makers' tactile firmware: their blocks, connected as in their block diagram QuadrupleBuffer.bdf;
-- bytes in. Prints the pins at each of the 16 ticks of periods of 40 kHz, after the last byte.
library ieee;
use ieee.std_logic_1164.all;
use std.textio.all;
use ieee.std_logic_textio.all;

entity tactile is
    generic (bytes : string; periods : integer);
end entity;

architecture simulated of tactile is
    constant HALF : time := 97656250 fs;        -- half a period of 5.12 MHz from the makers' PLL
    constant BIT_TIME : time := 1 sec / 230400;
    signal clock : std_logic := '0';
    signal serial : std_logic := '1';
    signal count : std_logic_vector(6 downto 0);
    signal received, byte_ready, swap, swap_long, swap_late, set, set_long, set_late, changes : std_logic;
    signal byte, phase, address, changed : std_logic_vector(7 downto 0);
    signal step : std_logic_vector(4 downto 0);
    signal data : std_logic_vector(31 downto 0);
    signal shift, latch : std_logic;
    signal pins : std_logic_vector(255 downto 0) := (others => '0');
    signal sent : boolean := false;
begin
    clock <= not clock after HALF;
    serial_filter : entity work.RSSFilter_1 generic map (3) port map (clock, serial, received);
    counter : entity work.Counter generic map (7) port map (clock, count);
    reader : entity work.UARTReader generic map (23) port map (clock, received, byte_ready, byte);
    distribute : entity work.Distribute port map (
        CLK => clock, byte_in => byte_ready, q_in => byte, swap_out => swap, set_out => set, data_out => phase,
        address => address, ampModStep => step, debug_swap => open);
    modulator : entity work.AmpModulator port map (count(2), step, changed, changes);
    swap_expander : entity work.PulseExpander generic map (16) port map (clock, swap, swap_long);
    set_expander : entity work.PulseExpander generic map (16) port map (clock, set, set_long);
    swap_buffer : entity work.LatchBuffer port map (count(2), swap_long, swap_late);
    set_buffer : entity work.LatchBuffer port map (count(2), set_long, set_late);
    channels : entity work.AllChannels generic map (256) port map (
        clk8 => clock, clk => count(2), chgClock => changes, counter => count, pulse_length => changed,
        swap => swap_late, phase => phase, set => set_late, address => address, data_out => data);

    shift <= not clock;
    latch <= count(2);
    registers : for chip in 0 to 31 generate
        signal shifted : std_logic_vector(7 downto 0) := x"00";
    begin
        process (shift) begin
            if rising_edge(shift) then
                shifted <= shifted(6 downto 0) & data(chip);
            end if;
        end process;
        process (latch) begin
            if rising_edge(latch) then
                pins(8 * chip + 7 downto 8 * chip) <= shifted(3) & shifted(4) & shifted(5) & shifted(6)
                    & shifted(7) & shifted(0) & shifted(1) & shifted(2);
            end if;
        end process;
    end generate;

    process
        type characters is file of character;
        file source : characters open read_mode is bytes;
        variable letter : character;
        variable value : integer;
    begin
        wait for 100 us;
        while not endfile(source) loop
            read(source, letter);
            value := character'pos(letter);
            serial <= '0';
            wait for BIT_TIME;
            for place in 0 to 7 loop
                serial <= '1' when (value / 2 ** place) mod 2 = 1 else '0';
                wait for BIT_TIME;
            end loop;
            serial <= '1';
            wait for 2 * BIT_TIME;
        end loop;
        wait for 100 us;
        sent <= true;
        wait for periods * 25 us;
        std.env.finish;
    end process;

    process
        variable row : line;
    begin
        wait until sent;
        loop
            wait until rising_edge(count(2));
            wait for 1 ns;
            hwrite(row, pins);
            writeline(output, row);
        end loop;
    end process;
end architecture;
